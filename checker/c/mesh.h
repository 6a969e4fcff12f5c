/* Meshes: triangles of STL, OBJ and COLLADA files, and the pieces in which they hang together. */
#ifndef EVENROAD_MESH_H
#define EVENROAD_MESH_H

#include "base.h"
#include "files.h"

typedef struct {
  Vector* corners; /* three for each triangle */
  size_t triangles, room;
  size_t distinct; /* corners after `keep_distinct`, which leaves them sorted */
  /* From `find_pieces`: for each triangle the first one of its piece, and whether that piece is closed. */
  size_t* piece;
  bool* closed;
} Mesh;

void add_triangle(Mesh* mesh, Vector a, Vector b, Vector c);
Mesh* read_mesh(File file, const char* path);
void read_collada(Mesh* mesh, File file, const char* path);
void find_pieces(Mesh* mesh);
void keep_distinct(Mesh* mesh);

#endif
