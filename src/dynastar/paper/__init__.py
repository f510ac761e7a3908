"""The paper's tables and figures, remade on thousands of maps."""
