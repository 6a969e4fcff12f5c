/* Certificates of pairs: two links never touch, whatever the joints between them do. */
#ifndef EVENROAD_NEVER_H
#define EVENROAD_NEVER_H

#include "proof.h"

/* The pairs that a certificate names. */
void find_named_pairs(Model* model);

/* The cell that is the lowest state of all ranges. */
double (*lowest_cell(const Model* model))[2];

/* Begin a diagonal of the cell of a pair that halving `level` times comes to, as the bits of `index` say.  Along it
   some of the joints between the two links go backwards, by the bits of `back`. */
void begin_cell(const Model* model, const Pair* pair, size_t level, uint64_t index, size_t back, Stretch* stretch);

#endif
