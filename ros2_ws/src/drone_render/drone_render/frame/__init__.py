"""What a picture shows, and when: cameras, object poses, lights, and the schedule of frames. Arrays, without OpenGL."""
