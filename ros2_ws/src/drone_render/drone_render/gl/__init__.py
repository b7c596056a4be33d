"""Everything that uses OpenGL: the context, shader programs, and the passes that draw a picture."""
