/* Robot and scene as their files say, before a certificate names the joints that move. */
#ifndef EVENROAD_INPUTS_H
#define EVENROAD_INPUTS_H

#include "mesh.h"
#include "tree.h"

enum { BOX = 1, SPHERE, CYLINDER, CAPSULE, MESH, PLANE };

typedef struct {
  int kind;
  double size[3]; /* of a box; radius and length of others */
  Mesh* mesh;
  bool convex;
  double clearance;
  Pose pose; /* in its link, or in the scene */
} Shape;

/* A list of shapes with room for more. */
typedef struct {
  Shape* shapes;
  size_t count, room;
} Shapes;

typedef struct {
  const char* name;
  Shapes shapes;
  size_t parent_joint; /* NONE for the root */
} Link;

enum { FIXED = 1, TURNS, SLIDES };

typedef struct {
  const char* name;
  int kind;
  size_t parent, child, follows; /* links; the joint that it mimics, or NONE */
  double multiplier, offset, lower, upper;
  bool limited;
  Pose pose;
  Vector axis;
} Joint;

typedef struct {
  const char* name;
  Shape shape;
} Obstacle;

typedef struct {
  const char* name;
  size_t link;
  Shapes shapes;
  const Entry* touches; /* or NULL */
} Attached;

/* Where meshes are looked for: the URDF's folder, and packages as "NAME=FOLDER". */
typedef struct {
  const char* folder;
  const char* const* packages;
  size_t package_count;
} Places;

typedef struct {
  Link* links;
  Joint* joints;
  Obstacle* obstacles;
  Attached* attached;
  size_t link_count, joint_count, obstacle_count, attached_count, root;
  const Entry *allowed, *limits; /* of the scene, or NULL */
  bool* disabled;                /* for each two links, whether the SRDF disables their pair */
  size_t disabled_count;
  uint8_t digest[32];
} Inputs;

#define NONE SIZE_MAX

Inputs* read_inputs(const char* urdf, const char* scene, const char* srdf, Places places);
void read_scene(Inputs* inputs, const char* path, Sha256* hash);
size_t link_named(const Inputs* inputs, const char* name);
size_t joint_named(const Inputs* inputs, const char* name);
size_t obstacle_named(const Inputs* inputs, const char* name);
void add_shape(Shapes* shapes, Shape shape);

#endif
