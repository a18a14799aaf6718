"""What rays add to what the camera sees: shadows, ambient occlusion, and what mirrors show.

World        every ray's questions about one scene, holes and glass panes in its materials included
occlusion    how much of the sky a point sees
reflection   the ray that continues from a shiny point
"""
