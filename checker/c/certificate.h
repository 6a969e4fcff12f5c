/* A certificate of a path, that there is none, or of pairs of links: its header, its points, and what follows them. */
#ifndef EVENROAD_CERTIFICATE_H
#define EVENROAD_CERTIFICATE_H

#include "base.h"

#define FARTHEST 1000.0 /* largest value of a joint, or coordinate of a ball */

/* A value of a joint, or the padding of a link. */
typedef struct {
  const char* name;
  double value;
} Named;

/* What a joint does not exceed. */
typedef struct {
  const char* name;
  double velocity, acceleration;
} Limit;

/* A constraint: a unit vector of a link, or a point, is within `limit` of a box. */
typedef struct {
  const char* link;
  bool is_axis;
  double within, xyzw[4], limit; /* as said, and as a distance */
  Vector part, low, high;        /* of the link, and of the box: of an axis both are its direction */
  Pose box;
} Kept;

/* A goal that any posture reaches: the origin of a link near a point and, if it is turned, near a rotation. */
typedef struct {
  const char* link;
  bool turned;
  double near, tilt, xyzw[4];
  Pose pose;
} PoseGoal;

/* Cells of some columns of the points, and an answer to each; of a certificate that there is no path.  Of one of pairs:
   the numbers of two bodies, and the columns along which cells are halved, one after the other. */
typedef struct {
  size_t *columns, column_count, answer_count;
  const uint8_t* answers;
} Tree;

typedef struct {
  uint8_t digest[32];
  bool of_no_path, of_pairs;
  const char** joints;
  Named *held, *padding;
  size_t joint_count, held_count, padding_count;
  Kept* kept; /* axes first */
  size_t axis_count, kept_count;
  Limit* limits;
  size_t limit_count;
  double clearance, tolerance;
  size_t degree, motions, answer_count, direction_count, points;
  double* values; /* of a point, one for each joint */
  const uint8_t *answers, *directions, *carried;
  size_t carried_size, carried_count;
  Tree* trees; /* of a certificate that there is no path; its points are the start and the goals */
  PoseGoal* poses;
  size_t goals, pose_count, ball_count, witness_count, tree_count;
  const uint8_t *balls, *witnesses;
  const char *robot, *scene; /* digests of the files of which carried ones were made, or NULL */
} Certificate;

Certificate* read_certificate(File file);

/* The column of a joint's name in the points, or NONE. */
size_t column_of(const Certificate* certificate, const char* name);
size_t bytes_of_answer(const Certificate* certificate, const Tree* tree);
int answer_at(const Certificate* certificate, size_t index);
float float_at(const uint8_t* data);
Vector direction_at(const Certificate* certificate, size_t index); /* of length 1 */

#endif
