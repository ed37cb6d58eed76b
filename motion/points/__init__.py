"""Points in space, joints of a body and landmarks of a face, and the motion that they tell."""
