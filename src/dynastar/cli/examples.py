"""Examples for each command's ``--help``."""

PLAN_EXAMPLES = """\
examples:
  dynastar plan office.yaml --start 2 2 --goal 38 23 --radius 0.25
  dynastar plan office.yaml --start 2 2 --goal 38 23 --planner astar --out plan.png
  dynastar plan AR0011SR.map --start 239 357 --goal 194 312 --json

For ROS maps X Y are metres in the map's frame. For MovingAI .map files they are integers, the
file's column and row; a cell is 1 m, and the path has cell centres at + 0.5."""

RUN_EXAMPLES = """\
examples:
  dynastar run examples/office/office.toml --out out/office
  dynastar run office.toml --seed 7 --preset paper --json > summary.json
  dynastar run office.toml --set dwa.horizon=2 --set reverse=false
  dynastar run office.toml --bag out/office-bag     # opens in Foxglove and RViz, see dynastar replay

Writes report.html, figure.png, animation.gif, summary.json, episode.npz and config.json into DIR."""

BENCH_EXAMPLES = """\
examples:
  dynastar bench movingai --data data/movingai
  dynastar bench barn --data data --workers 2 --json-out barn.json
  dynastar bench barn --replay 17               # mission 17 again, with pictures and the episode
  dynastar bench barn --set dwa.horizon=2 --save-failures out/failures --json-out b.json
  dynastar bench maps --controller pure_pursuit
  dynastar bench scenarios --data examples/features
  dynastar bench all --quick --data data --out out/bench
  dynastar bench compare barn.json b.json

A mission has the suite's own number. A run with --json-out that was cut off goes on where it ended when
it is called again; until then its rows are in FILE.rows.jsonl. `all` runs every suite whose data and
extras are there and writes all.json, all.txt and all.png into DIR. `compare` takes two results of the
same missions and says for each suite whether the second is better, worse or not clearly different."""

PAPER_EXAMPLES = """\
examples:
  dynastar paper table1
  dynastar paper table3 --maps 100 --out out/hundred --json-out -
  dynastar paper all --json-out paper.json

  presets   the settings in which the presets paper and default differ
  table1    traditional against improved A*, on the own map, over maps of 40 x 40 cells (random, rooms,
            maze, office; corner to corner), and over a tenth as many of 512 x 512; 2 minutes
  table3    the improved A* alone against the hybrid, in the own world and over worlds of 20 x 20 cells
            with unknown blocks and a mover, by the presets default and paper, and a tenth of them by
            the controller printed; 40 minutes for 1000
  ablation  each term of Eqs. 2 and 9 left out or read otherwise, and each part of the whole, on worlds
            of the suites paper and people; 2 hours for 100 of each
  figures   Figs. 1 to 8; 10 seconds

Times are for two cores. Writes tables (.md), a line for each map or world (.csv) and pictures (.png,
.svg) into DIR, and goes on from the .jsonl there where it was cut off."""

WARMUP_EXAMPLES = """\
examples:
  dynastar warmup
  dynastar warmup --clear

The kernels lie in ~/.cache/dynastar (or $XDG_CACHE_HOME/dynastar), a folder for each version of
their sources; $NUMBA_CACHE_DIR, if it is set, is where they lie instead and is not cleared."""

DEMO_EXAMPLES = """\
examples:
  dynastar demo
  dynastar demo --list
  dynastar demo --copy my-examples"""

INFO_EXAMPLES = """\
examples:
  dynastar info office.yaml
  dynastar info examples/office/office.toml --out office.png
  dynastar info out/office/episode.npz --json"""

VIEW_EXAMPLES = """\
examples:
  dynastar view out/office --open
  dynastar view out/default out/paper --out both.html
  dynastar view failures/barn-17.npz

Episodes of `dynastar run` have all that the page can show; those that were written without it lack
candidates, terms and tracks."""

SCHEMA_EXAMPLES = """\
examples:
  dynastar schema --out scenario.schema.json"""

ROS_EXAMPLES = """\
examples:
  dynastar ros-sim examples/office/office.toml
  dynastar ros --scenario examples/office/office.toml
  dynastar ros --scenario office.toml --ros-args -p bag:=out/bag     # records, see dynastar replay
  dynastar ros --ros-args -p robot:=jackal -p pose_source:=amcl -r cmd_vel:=/base/cmd_vel
  ros2 topic pub --once /goal_pose geometry_msgs/msg/PoseStamped \\
      '{header: {frame_id: map}, pose: {position: {x: 7.2, y: 10.0}, orientation: {w: 1.0}}}'"""

REPLAY_EXAMPLES = """\
examples:
  dynastar run examples/office/office.toml --bag out/office-bag
  dynastar replay out/office-bag
  dynastar replay out/office-bag --set dwa.horizon=2 --set dwa.weights.vel=0.3
  dynastar replay robot.mcap --robot turtlebot3_burger --pose tf --topic scan=/front/scan

Writes commands.csv, summary.json and figure.png into DIR. Recordings by dynastar are ticked when they
were and give the recorded commands; others are ticked at each scan. Nothing is simulated: the robot
moves as it was recorded, whatever is commanded."""

PLAY_EXAMPLES = """\
examples:
  dynastar play
  dynastar play crowd --open
  dynastar play my_scene.toml --port 9000
  dynastar play --host 0.0.0.0        # for others, too: the address that is printed has a token

Needs pip install 'dynastar[play]'. The page saves the scene as a scenario file and the drive as an
episode, for dynastar run and dynastar view."""

EXAMPLES = """\
examples:
  dynastar demo
  dynastar info office.yaml --out office.png
  dynastar plan office.yaml --start 2 2 --goal 38 23 --radius 0.25
  dynastar run examples/office/office.toml --out out/office
  dynastar bench paper --missions 20
  dynastar bench all --quick --data data
  dynastar paper table1 --maps 100
  dynastar play
  dynastar warmup"""
