// The legend: what is drawn on the maps, with a box for each layer that can be hidden.

// Name of a layer: its words, the shape of its sign and the colours of the sign.
const LAYERS = {
  plans: ["planned path; older ones fade", "line", "plan"],
  driven: ["path driven", "line", "driven"],
  candidates: ["candidate motions: best blue, worst orange, refused grey", "scores"],
  movers: ["people and other moving obstacles", "disc", "mover"],
  tracks: ["tracked by the robot, predicted 1 s and 2 s ahead", "rings", "mover"],
  seen: ["obstacles the lidar has seen", "square", "seen"],
  explored: ["cells the path search visited", "square", "explored"],
  follow: ["keep the robot in view", "none"],
};
const FIXED = [["robot", "disc", "robot"], ["goal", "rings", "driven"], ["wall of the map", "square", "occupied"],
  ["obstacle that the map lacks", "square", "obstacle"], ["unknown area", "square", "unknown"],
  ["keep-out zone", "square", "keepout"]];

const layers = {};

function sign(shape, colour) {
  const made = element("span", { className: `sign ${shape}` });
  if (colour) made.style.setProperty("--sign", `var(--${colour})`);
  return made;
}

// Fills the legend; ``redraw`` is called when a layer is shown or hidden.
function makeLegend(redraw) {
  const place = document.getElementById("legend");
  for (const [name, [words, shape, colour]] of Object.entries(LAYERS)) {
    layers[name] = name !== "follow";
    const box = element("input", { type: "checkbox", name, checked: layers[name] });
    box.addEventListener("change", () => { layers[name] = box.checked; redraw(); });
    place.append(element("label", {}, box, sign(shape, colour), words));
  }
  for (const [words, shape, colour] of FIXED) {
    place.append(element("span", { className: "fixed" }, sign(shape, colour), words));
  }
}
