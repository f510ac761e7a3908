"""The playground: a simulated world that is driven live and changed from a page in the browser."""
