"""Pictures of plans and missions: ``figure`` for print, ``animation`` for watching."""
