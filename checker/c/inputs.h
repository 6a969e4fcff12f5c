/* Robot and scene as their files say, before a certificate names the joints that move. */
#ifndef EVENROAD_INPUTS_H
#define EVENROAD_INPUTS_H

#include "certificate.h"

typedef struct {
  Vector* corners; /* three for each triangle */
  size_t triangles, room;
  size_t part, *parts; /* of the file, for each triangle: pieces are within one */
  size_t distinct;     /* corners after `keep_distinct`, which leaves them sorted */
  /* From `find_pieces`: for each triangle the first one of its piece, NONE for one that repeats an earlier one,
   * and whether that piece is closed. */
  size_t* piece;
  bool* closed;
} Mesh;

Mesh* read_mesh(File file, const char* path, const double scale[3]);
void read_collada(Mesh* mesh, File file, const char* path);
void add_triangle(Mesh* mesh, Vector a, Vector b, Vector c);
void keep_distinct(Mesh* mesh);
void find_pieces(Mesh* mesh);

enum { BOX, SPHERE, CYLINDER, CAPSULE, MESH, PLANE, CLOUD, KINDS };
extern const char* const kind_names[KINDS];

typedef struct {
  int kind;
  double size[3]; /* of a box; radius and length of others */
  Mesh* mesh;     /* or the points of a cloud, as its distinct corners */
  bool convex;
  double clearance;
  Pose pose; /* in its link, or in the scene */
} Shape;

/* Read the size of a box, or the radius and length of others, and tell whether it is more than 0. */
bool read_size(Shape* shape, const Entry* entry, const char* const keys[3], const char* where);

/* A link, or an object that is attached to one. */
typedef struct {
  const char* name;
  Shape* shapes;
  size_t count;
  size_t parent_joint;  /* of a link, NONE for the root */
  size_t link;          /* of an object, the one that carries it */
  const Entry* touches; /* of an object, or NULL */
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

/* An obstacle that a link, or an attached object, may touch. */
typedef struct {
  const char *obstacle, *body;
} Contact;

typedef struct {
  Link *links, *attached;
  Joint* joints;
  Obstacle* obstacles;
  Contact* allowed; /* sorted */
  size_t link_count, joint_count, obstacle_count, attached_count, allowed_count, root;
  const Entry* limits; /* of the scene, or NULL */
  bool* disabled;      /* for each two links, whether the SRDF disables their pair */
  size_t disabled_count;
  uint8_t digest[32];
  Carried* carried; /* by the certificate, as it has them */
  size_t carried_count;
} Inputs;

/* What files are given; NULL for those that the certificate carries, and for no SRDF. */
typedef struct {
  const char *robot, *scene, *srdf;
  const char* const* packages; /* as "NAME=FOLDER" */
  size_t package_count;
} Given;

Inputs* read_inputs(Given given, const Certificate* certificate);
void read_robot(Inputs* inputs, const char* urdf, const char* srdf, Files* files);
void read_scene(Inputs* inputs, const char* path, Files* files);
size_t link_named(const Inputs* inputs, const char* name);
size_t joint_named(const Inputs* inputs, const char* name);
size_t obstacle_named(const Inputs* inputs, const char* name);

#endif
