"""Speed of the renderer beside other renderers, all on the CPU."""
