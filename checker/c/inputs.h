/* Robot and scene as their files say, before a certificate names the joints that move. */
#ifndef EVENROAD_INPUTS_H
#define EVENROAD_INPUTS_H

#include "certificate.h"

/* Numbers of three points. */
typedef struct {
  size_t corner[3];
} Triangle;

/* Triangles that hang together by equal corners: `count` of the members from `begin` on, the earliest one first. */
typedef struct {
  size_t begin, count;
  bool looked_at, closed;
} Piece;

typedef struct {
  Vector* points; /* the distinct corners, of each part of a file by itself; or those of a cloud */
  Triangle* triangles;
  size_t point_count, triangle_count;
  Piece* pieces; /* from `find_pieces` */
  size_t piece_count, *members;
} Mesh;

/* Triangles as a file has them: three corners each, and the part of the file that each is in. */
typedef struct {
  Vector* corners;
  size_t *parts, count, room, part;
} Faces;

void add_triangle(Faces* faces, Vector a, Vector b, Vector c);
void read_collada(Faces* faces, File file, const char* path);

/* The mesh of a file; if it is convex, all of its parts are one. */
Mesh* read_mesh(File file, const char* path, const double scale[3], bool convex);
void find_pieces(Mesh* mesh);

/* Tell whether a piece is closed, and leave out its triangles that repeat an earlier one. */
bool is_closed(const Mesh* mesh, Piece* piece);

enum { BOX, SPHERE, CYLINDER, CAPSULE, MESH, PLANE, CLOUD, KINDS };
extern const char* const kind_names[KINDS];

typedef struct {
  int kind;
  double size[3]; /* of a box; radius and length of others */
  Mesh* mesh;     /* or the points of a cloud */
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
