#include "pairs.h"

#include <string.h>

#include "never.h"

static Body* body_named(const Model* model, const char* name) {
  for (size_t i = 0; i < model->body_count; ++i) {
    if (!strcmp(model->bodies[i].name, name)) return model->bodies + i;
  }
  return NULL;
}

void find_allowed(Model* model) {
  const Inputs* inputs = model->inputs;
  const Certificate* certificate = model->certificate;
  for (size_t i = 0; i < model->body_count; ++i) {
    model->bodies[i].allowed = take(inputs->obstacle_count + 1, sizeof(bool));
  }
  for (size_t i = 0; i < certificate->padding_count; ++i) {
    Body* body = body_named(model, certificate->padding[i].name);
    if (!body) fail(REFUSED, "padding of no body: %.60s", certificate->padding[i].name);
    body->padding = certificate->padding[i].value;
  }
  for (size_t i = 0; i < inputs->allowed_count; ++i) {
    Body* body = body_named(model, inputs->allowed[i].body);
    if (body) body->allowed[obstacle_named(inputs, inputs->allowed[i].obstacle)] = true;
  }
}

/* Bodies of one frame with the same padding and allowed obstacles, against all other obstacles. */
static void find_obstacle_pairs(Model* model) {
  size_t count = model->inputs->obstacle_count;
  for (size_t i = 0; i < model->body_count; ++i) {
    const Body* body = model->bodies + i;
    model->group[i] = NONE;
    size_t same = 0; /* the first body against the same obstacles */
    for (size_t k = 0; k < i; ++k) {
      const Body* other = model->bodies + k;
      if (model->group[k] != k || memcmp(other->allowed, body->allowed, count) != 0) continue;
      if (!same) same = k + 1;
      if (other->frame == body->frame && other->padding == body->padding) model->group[i] = k;
    }
    if (!body->frame || model->group[i] != NONE) continue;
    model->group[i] = i;
    Solid** left = take(count + 1, sizeof *left);
    size_t left_count = 0;
    for (size_t k = 0; k < count; ++k) {
      if (!body->allowed[k]) left[left_count++] = model->bodies[model->body_count + k].solids[0];
    }
    if (!left_count) continue;
    Pair* pair = model->pairs + model->pair_count++;
    *pair = (Pair){.margin = model->certificate->clearance + body->padding, .a = i, .b = NONE};
    for (size_t k = 0; same && k + 1 < model->pair_count; ++k) {
      if (model->pairs[k].a == same - 1) pair->second = model->pairs[k].second;
    }
    if (!pair->second) pair->second = node_of(left, left_count, 0);
  }
}

/* The node of all bodies that go with the first body of a group. */
static Node* group_node(const Model* model, size_t first) {
  size_t count = 0, all = 0;
  for (size_t i = first; i < model->body_count; ++i) all += model->group[i] == first ? model->bodies[i].count : 0;
  Solid** solids = take(all + 1, sizeof *solids);
  for (size_t i = first; i < model->body_count; ++i) {
    const Body* body = model->bodies + i;
    for (size_t k = 0; model->group[i] == first && k < body->count; ++k) solids[count++] = body->solids[k];
  }
  return count == model->bodies[first].count ? model->bodies[first].node
                                             : node_of(solids, count, model->bodies[first].frame);
}

/* Tell whether a link is the next one with shapes above another one, with exactly one movable joint between them. */
static bool is_next_above(const Model* model, const Body* lower, const Body* upper) {
  const Inputs* inputs = model->inputs;
  if (lower->attached != NONE || upper->attached != NONE) return false;
  int movable = 0;
  for (size_t link = lower->link; inputs->links[link].parent_joint != NONE;) {
    const Joint* above = inputs->joints + inputs->links[link].parent_joint;
    movable += above->kind != FIXED;
    link = above->parent;
    if (body_named(model, inputs->links[link].name)) return link == upper->link && movable == 1;
  }
  return false;
}

/* Tell whether an attached object may touch a body: the link that carries it, or one that it names. */
static bool may_touch(const Model* model, const Body* held, const Body* other) {
  if (held->attached == NONE) return false;
  if (other->attached == NONE && other->link == held->link) return true;
  const Entry* touches = model->inputs->attached[held->attached].touches;
  for (const Entry* each = touches ? touches->child : NULL; each; each = each->next) {
    if (!strcmp(each->text, other->name) && obstacle_named(model->inputs, each->text) == NONE) return true;
  }
  return false;
}

bool is_left_out(const Model* model, const Body* a, const Body* b) {
  const Inputs* inputs = model->inputs;
  if (a->frame == b->frame || may_touch(model, a, b) || may_touch(model, b, a)) return true;
  if (!inputs->disabled_count) return is_next_above(model, a, b) || is_next_above(model, b, a);
  bool links = a->attached == NONE && b->attached == NONE;
  return links && inputs->disabled[a->link * inputs->link_count + b->link];
}

void find_pairs(Model* model) {
  const Inputs* inputs = model->inputs;
  size_t count = model->body_count;
  model->all_count = count + inputs->obstacle_count;
  for (size_t i = count; i < model->all_count; ++i) {
    const Obstacle* obstacle = inputs->obstacles + (i - count);
    Body body = {.name = obstacle->name, .link = NONE, .attached = NONE, .count = 1};
    body.solids = take(1, sizeof *body.solids);
    body.solids[0] = take(1, sizeof **body.solids);
    *body.solids[0] = solid_of(&obstacle->shape, &obstacle->shape.pose);
    model->bodies[i] = body;
  }
  if (model->certificate->of_pairs) {
    find_named_pairs(model);
    return;
  }
  model->pairs = take(count + count * count / 2 + 1, sizeof *model->pairs);
  model->group = take(count + 1, sizeof *model->group);
  find_obstacle_pairs(model);
  for (size_t i = 0; i < model->pair_count; ++i) model->pairs[i].first = group_node(model, model->pairs[i].a);
  for (size_t i = 0; i < count; ++i) {
    for (size_t k = i + 1; k < count; ++k) {
      const Body *a = model->bodies + i, *b = model->bodies + k;
      if (is_left_out(model, a, b)) continue;
      model->pairs[model->pair_count++] = (Pair){.first = a->node, .second = b->node, .a = i, .b = k};
    }
  }
}
