#include "witnesses.h"

#include <stdlib.h>

#include "pairs.h"
#include "solids.h"

/* Tell whether a witness may name a solid: a mesh, a cloud or a thin box has no distance here. */
static bool has_distance(const Solid* solid) {
  if (solid->shape->kind == MESH || solid->shape->kind == CLOUD) return false;
  for (int i = 0; solid->shape->kind == BOX && i < 3; ++i) {
    if (solid->shape->size[i] < 2 * SPARE) return false;
  }
  return true;
}

double distance_from(const Solid* solid, Vector point) {
  double o[3] = {0, 0, 0};
  const Vector *points = solid->points, *last = points + solid->point_count - 1;
  size_t count = solid->point_count == 8 ? 3 : 2;
  Vector from = difference(point, scaled(0.5, sum(points[0], *last)));
  if (count == 3) {
    for (int i = 0; i < 3; ++i) {
      Vector half = scaled(0.5, difference(points[1 << i], points[0]));
      o[i] = fabs(dot(from, half)) / length(half) - length(half);
    }
  } else {
    double along = dot(from, solid->axis);
    o[0] = length(difference(from, scaled(along, solid->axis))) - solid->disc;
    o[1] = fabs(along) - length(difference(*last, points[0])) / 2;
  }
  double outside = 0, inside = -INFINITY;
  for (size_t i = 0; i < count; ++i) {
    outside = hypot(outside, fmax(o[i], 0));
    inside = fmax(inside, o[i]);
  }
  return outside + fmin(inside, 0) - solid->ball;
}

/* The distance of a point from a segment. */
static double from_segment(Vector point, Vector a, Vector b) {
  Vector line = difference(b, a), from = difference(point, a);
  double size = dot(line, line), share = size > 0 ? fmin(1, fmax(0, dot(from, line) / size)) : 0;
  return length(difference(from, scaled(share, line)));
}

/* The distance of a point from a triangle: from its plane where the point is above it, else from its edges. */
static double from_triangle(Vector point, const Vector* c) {
  Vector normal = cross(difference(c[1], c[0]), difference(c[2], c[0]));
  double area = length(normal), nearest = INFINITY;
  bool above = area > 0;
  for (int i = 0; i < 3; ++i) {
    Vector a = c[i], b = c[(i + 1) % 3];
    above = above && dot(cross(difference(b, a), difference(point, a)), normal) >= 0;
    nearest = fmin(nearest, from_segment(point, a, b));
  }
  return above ? fmin(nearest, fabs(dot(difference(point, c[0]), normal)) / area) : nearest;
}

static bool is_inside_surface(const Solid* solid, const Ball* ball) {
  find_pieces(solid->shape->mesh);
  const Mesh* mesh = solid->shape->mesh;
  for (size_t i = 0; i < mesh->piece_count; ++i) {
    Piece* piece = mesh->pieces + i;
    double nearest = is_closed(mesh, piece) ? INFINITY : -INFINITY;
    for (size_t k = 0; k < piece->count && nearest >= ball->radius + SPARE; ++k) {
      Vector c[3];
      for (size_t n = 0; n < 3; ++n) c[n] = corner_at(solid, mesh->members[piece->begin + k], n);
      nearest = fmin(nearest, from_triangle(ball->centre, c));
    }
    if (nearest >= ball->radius + SPARE && is_inside(ball->centre, solid, piece)) return true;
  }
  return false;
}

static void require_inside_body(const Body* body, const Ball* ball) {
  for (size_t i = 0; i < body->count; ++i) {
    const Solid* solid = body->solids[i];
    if (has_distance(solid) && distance_from(solid, ball->centre) <= -ball->radius - SPARE) return;
    if (is_surface(solid) && is_inside_surface(solid, ball)) return;
  }
  fail(REFUSED, "a ball is not inside of %.60s", body->name);
}

static Ball* read_balls(const Model* model) {
  const Certificate* certificate = model->certificate;
  Ball* balls = take(certificate->ball_count + 1, sizeof *balls);
  for (size_t i = 0; i < certificate->ball_count; ++i) {
    const uint8_t* data = certificate->balls + 18 * i;
    double numbers[4];
    for (int k = 0; k < 4; ++k) {
      numbers[k] = float_at(data + 2 + 4 * k);
      if (!(fabs(numbers[k]) <= FARTHEST)) fail(REFUSED, "a ball that is no number, or too large");
    }
    balls[i] = (Ball){(size_t)little_endian(data, 2), {numbers[0], numbers[1], numbers[2]}, numbers[3]};
    if (balls[i].body >= model->all_count) fail(REFUSED, "a ball in no body");
    if (!(balls[i].radius >= 0)) fail(REFUSED, "a ball of a radius below 0");
    require_inside_body(model->bodies + balls[i].body, balls + i);
  }
  return balls;
}

/* What witnesses name: every shape that is not made of triangles, in the order of bodies, then the balls. */
static Witness* targets_of(const Model* model, const Ball* balls, size_t* count) {
  size_t room = model->certificate->ball_count + 1;
  for (size_t body = 0; body < model->all_count; ++body) room += model->bodies[body].count;
  Witness* targets = take(room, sizeof *targets);
  for (size_t body = 0; body < model->all_count; ++body) {
    for (size_t i = 0; i < model->bodies[body].count; ++i) {
      const Solid* solid = model->bodies[body].solids[i];
      if (!is_surface(solid)) targets[(*count)++] = (Witness){.body = body, .solid = solid};
    }
  }
  for (size_t i = 0; i < model->certificate->ball_count; ++i) {
    targets[(*count)++] = (Witness){.body = balls[i].body, .other = balls + i};
  }
  return targets;
}

/* What two bodies keep from each other; fails unless the claim is about them. */
static double kept_by(const Model* model, size_t a, size_t b) {
  size_t obstacle = a < b ? b : a, body = a < b ? a : b; /* obstacles are behind all other bodies */
  const Body *first = model->bodies + body, *second = model->bodies + obstacle;
  bool of_claim = body < model->body_count && first->frame != second->frame;
  if (of_claim && obstacle >= model->body_count) {
    if (!first->allowed[obstacle - model->body_count]) return model->certificate->clearance + first->padding;
  } else if (of_claim && !is_left_out(model, first, second)) {
    return 0;
  }
  fail(REFUSED, "%.60s and %.60s may touch", first->name, second->name);
}

static int by_bodies(const void* a, const void* b) {
  const Witness *p = *(Witness* const*)a, *q = *(Witness* const*)b;
  if (p->ball->body != q->ball->body) return p->ball->body < q->ball->body ? -1 : 1;
  if (p->body != q->body) return p->body < q->body ? -1 : 1;
  return (p > q) - (p < q);
}

Witness* read_witnesses(const Model* model) {
  const Certificate* certificate = model->certificate;
  size_t count = certificate->witness_count, target_count = 0;
  const Ball* balls = read_balls(model);
  const Witness* targets = targets_of(model, balls, &target_count);
  Witness *witnesses = take(count + 1, sizeof *witnesses), **sorted = take(count + 1, sizeof *sorted);
  for (size_t i = 0; i < count; ++i) {
    size_t ball = (size_t)little_endian(certificate->witnesses + 4 * i, 2);
    size_t target = (size_t)little_endian(certificate->witnesses + 4 * i + 2, 2);
    if (ball >= certificate->ball_count || target >= target_count) fail(REFUSED, "a witness of nothing");
    witnesses[i] = targets[target];
    witnesses[i].ball = balls + ball;
    if (witnesses[i].solid && !has_distance(witnesses[i].solid)) {
      fail(REFUSED, "a witness of a solid that has no distance");
    }
    witnesses[i].kept = kept_by(model, balls[ball].body, witnesses[i].body);
    sorted[i] = witnesses + i;
  }
  qsort(sorted, count, sizeof *sorted, by_bodies);
  for (size_t i = 1; i < count; ++i) {
    sorted[i]->repeats = sorted[i]->ball->body == sorted[i - 1]->ball->body && sorted[i]->body == sorted[i - 1]->body;
  }
  return witnesses;
}
