/* Which bodies of a model must stay apart. */
#ifndef EVENROAD_PAIRS_H
#define EVENROAD_PAIRS_H

#include "model.h"

/* Note what the certificate pads and the scene allows; `find_pairs` then makes the pairs in their order. */
void find_allowed(Model* model);
void find_pairs(Model* model);

/* Tell whether no certificate speaks of two bodies of the robot. */
bool is_left_out(const Model* model, const Body* a, const Body* b);

#endif
