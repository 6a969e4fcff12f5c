/* Solids: two surfaces that never touch may lie one inside of the other, which the first state shows. */
#ifndef EVENROAD_SOLIDS_H
#define EVENROAD_SOLIDS_H

#include "model.h"

/* Tell whether a point is inside of a closed piece of a mesh. */
bool is_inside(Vector point, const Solid* solid, const Piece* piece);

/* Refuse if a piece of one body begins inside of a closed piece of another; the number of open pieces that were met. */
size_t require_outside(const Model* model);

#endif
