/* A certificate: its header, its points, its answers and its directions. */
#ifndef EVENROAD_CERTIFICATE_H
#define EVENROAD_CERTIFICATE_H

#include "base.h"

/* A value of a joint, or the padding of a link. */
typedef struct {
  const char* name;
  double value;
} Named;

typedef struct {
  uint8_t digest[32];
  const char** joints;
  Named *held, *padding;
  size_t joint_count, held_count, padding_count;
  double clearance;
  size_t degree, motions, answer_count, direction_count, points;
  double* values; /* of a point, one for each joint */
  const uint8_t *answers, *directions, *carried;
  size_t carried_size;
  const char *robot, *scene; /* digests of the files of which carried ones were made, or NULL */
} Certificate;

Certificate* read_certificate(File file);
int answer_at(const Certificate* certificate, size_t index);
Vector direction_at(const Certificate* certificate, size_t index); /* of length 1 */

#endif
