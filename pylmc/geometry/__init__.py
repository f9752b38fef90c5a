"""What triangles alone tell: topology, holes, objects, the tree. Arrays in, arrays out."""
