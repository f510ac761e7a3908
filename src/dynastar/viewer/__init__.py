"""Pictures of plans and missions: ``figure`` for print, ``animation`` for watching."""

from dynastar.extras import require

require("viewer", "pictures need")
