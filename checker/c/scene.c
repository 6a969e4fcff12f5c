#include <stdio.h>
#include <string.h>

#include "inputs.h"

/* Refuse keys that are not among those in `known`, each after a blank. */
static void require_known(const Entry* mapping, const char* known, const char* where) {
  if (mapping->kind != MAPPING) fail(BAD_INPUT, "%s: no mapping", where);
  for (const Entry* each = mapping->child; each; each = each->next) {
    const char* found = strstr(known, joined(" ", each->key, " "));
    if (!found || strchr(each->key, ' ')) fail(BAD_INPUT, "%s: a key that is not read: %.60s", where, each->key);
  }
}

/* A number, or a list of them; `numbers` keep their values where there is none. */
static bool numbers_of(const Entry* mapping, const char* key, double* numbers, size_t count, const char* where) {
  const Entry* value = child_of(mapping, key);
  if (!value) return false;
  if (value->kind == SCALAR && count == 1) {
    read_numbers(value->text, numbers, 1, where);
    return true;
  }
  size_t i = 0;
  for (const Entry* each = value->child; value->kind == LIST && each; each = each->next, ++i) {
    if (i == count || each->kind != SCALAR) break;
    read_numbers(each->text, numbers + i, 1, where);
  }
  if (i != count || value->kind != LIST) fail(BAD_INPUT, "%s: %s must have %zu numbers", where, key, count);
  return true;
}

static bool is_true(const Entry* mapping, const char* key, const char* where) {
  const char* text = text_of(mapping, key, "false");
  bool yes = !strcmp(text, "true");
  if (!yes && strcmp(text, "false") != 0) fail(BAD_INPUT, "%s: %s must be true or false", where, key);
  return yes;
}

static Mesh* mesh_of(const Entry* entry, const char* scene, const char* where, Sha256* hash) {
  double scale[3] = {1, 1, 1};
  const Entry* given = child_of(entry, "scale");
  if (given && given->kind == SCALAR) {
    numbers_of(entry, "scale", scale, 1, where);
    scale[1] = scale[2] = scale[0];
  } else {
    numbers_of(entry, "scale", scale, 3, where);
  }
  const char* name = text_of(entry, "file", "");
  const char* path = joined(*name == '/' ? "" : folder_of(scene), name, "");
  Mesh* mesh = read_mesh(read_file(path, hash), path);
  for (size_t i = 0; i < 3 * mesh->triangles; ++i) {
    Vector* corner = mesh->corners + i;
    *corner = (Vector){scale[0] * corner->x, scale[1] * corner->y, scale[2] * corner->z};
  }
  return mesh;
}

static Shape shape_of(const Entry* entry, const char* more, const char* scene, const char* where, Sha256* hash) {
  static const char* const kinds[] = {"box", "sphere", "cylinder", "capsule", "mesh", "plane"};
  static const char* const sizes[] = {" size ", " radius ", " radius length ", " radius length ", " file scale convex ",
                                      " "};
  Shape shape = {0};
  const char* kind = text_of(entry, "shape", "");
  while (shape.kind < PLANE && strcmp(kinds[shape.kind], kind) != 0) ++shape.kind;
  if (shape.kind == PLANE) fail(BAD_INPUT, "%s: a shape that is not read: %.60s", where, kind);
  require_known(entry, joined(sizes[shape.kind], "shape xyz rpy xyzw cell ", more), where);
  ++shape.kind;
  bool sized = true;
  if (shape.kind == BOX) {
    sized = numbers_of(entry, "size", shape.size, 3, where);
  } else if (shape.kind == MESH) {
    shape.mesh = mesh_of(entry, scene, where, hash);
    shape.convex = is_true(entry, "convex", where);
    if (shape.convex) keep_distinct(shape.mesh);
  } else if (shape.kind != PLANE) {
    sized = numbers_of(entry, "radius", shape.size, 1, where);
    if (shape.kind != SPHERE) sized = numbers_of(entry, "length", shape.size + 1, 1, where) && sized;
  }
  bool flat = shape.kind != MESH && shape.kind != PLANE && shape.size[0] + shape.size[1] + shape.size[2] <= 0;
  for (int i = 0; i < 3; ++i) {
    if (!sized || flat || shape.size[i] < 0) fail(BAD_INPUT, "%s: a size that is missing, 0 or below", where);
  }
  double xyz[3] = {0, 0, 0}, rpy[3] = {0, 0, 0}, xyzw[4] = {0, 0, 0, 1};
  numbers_of(entry, "xyz", xyz, 3, where);
  Vector at = {xyz[0], xyz[1], xyz[2]};
  bool angles = numbers_of(entry, "rpy", rpy, 3, where), quaternion = numbers_of(entry, "xyzw", xyzw, 4, where);
  if (angles && quaternion) fail(BAD_INPUT, "%s: both rpy and xyzw", where);
  shape.pose = quaternion ? pose_of_quaternion(xyzw, at) : pose_of_angles(rpy, at);
  numbers_of(entry, "clearance", &shape.clearance, 1, where);
  if (!(shape.clearance >= 0 && shape.clearance <= 1)) fail(BAD_INPUT, "%s: clearance must be 0 to 1", where);
  return shape;
}

size_t obstacle_named(const Inputs* inputs, const char* name) {
  for (size_t i = 0; i < inputs->obstacle_count; ++i) {
    if (!strcmp(inputs->obstacles[i].name, name)) return i;
  }
  return NONE;
}

static size_t size_of(const Entry* entry) {
  size_t count = 0;
  for (const Entry* each = entry ? entry->child : NULL; each; each = each->next) ++count;
  return count;
}

/* A part of a scene; NULL if there is nothing in it. */
static const Entry* section(const Entry* scene, const char* key, bool or_list, const char* path) {
  const Entry* found = child_of(scene, key);
  if (found && found->kind == SCALAR && !*found->text) return NULL;
  if (found && found->kind != MAPPING && !(or_list && found->kind == LIST)) {
    fail(BAD_INPUT, "%s: %s is no mapping", path, key);
  }
  return found;
}

static void require_texts(const Entry* list, const char* where) {
  bool texts = list->kind == LIST;
  for (const Entry* each = list->child; each; each = each->next) texts = texts && each->kind == SCALAR;
  if (!texts) fail(BAD_INPUT, "%s: no list of names; contacts with parts are not read", where);
}

static void read_attached(Inputs* inputs, const Entry* entry, const char* path, Sha256* hash) {
  Attached* attached = inputs->attached + inputs->attached_count++;
  *attached = (Attached){.name = entry->key, .touches = child_of(entry, "touches")};
  add_shape(&attached->shapes, shape_of(entry, "link touches ", path, entry->key, hash));
  if (attached->touches) require_texts(attached->touches, entry->key);
  attached->link = link_named(inputs, text_of(entry, "link", ""));
  if (attached->link == NONE) fail(BAD_INPUT, "%s: no such link to be attached to", entry->key);
}

/* An entry as `shape: box, size: ...`, which `box: {size: ...}` and `sphere: 0.1` say, too; without its name. */
static Entry* in_full(const Entry* entry, const char* name) {
  static const char* const kinds[] = {"box", "sphere", "cylinder", "capsule"};
  Entry *full = take(1, sizeof *full), *shape = NULL;
  *full = (Entry){.key = name, .text = "", .kind = entry->kind};
  for (int i = 0; !child_of(entry, "shape") && i < 4; ++i) {
    if (!child_of(entry, kinds[i])) continue;
    if (shape) fail(BAD_INPUT, "%s: two shapes", name);
    shape = append(full, "shape", kinds[i], SCALAR);
  }
  for (const Entry* each = entry->child; each; each = each->next) {
    if (!entry->key && !strcmp(each->key, "name")) continue;
    bool short_form = shape && !strcmp(each->key, shape->text), mapping = each->kind == MAPPING;
    if (short_form && !mapping && strcmp(each->key, "sphere") != 0) fail(BAD_INPUT, "%s: no sizes", name);
    for (const Entry* one = short_form && mapping ? each->child : NULL; one; one = one->next) {
      if (child_of(entry, one->key) || child_of(full, one->key)) fail(BAD_INPUT, "%s: twice: %.40s", name, one->key);
      append(full, one->key, one->text, one->kind)->child = one->child;
    }
    if (short_form && mapping) continue;
    append(full, short_form ? "radius" : each->key, each->text, each->kind)->child = each->child;
  }
  return full;
}

/* The entries of a section that is a mapping, or a list whose entries have names. */
static Entry* named_entries(const Entry* section, const char* path) {
  Entry* all = take(1, sizeof *all);
  size_t i = 0;
  for (const Entry* each = section ? section->child : NULL; each; each = each->next, ++i) {
    if (each->kind != MAPPING) fail(BAD_INPUT, "%s: an entry that is no mapping", path);
    char number[32];
    snprintf(number, sizeof number, "%zu", i);
    const char* name = each->key;
    if (!name) name = text_of(each, "name", joined(text_of(each, "shape", "None"), " ", number));
    Entry* full = in_full(each, name);
    if (all->last) {
      all->last->next = full;
    } else {
      all->child = full;
    }
    all->last = full;
  }
  return all;
}

void read_scene(Inputs* inputs, const char* path, Sha256* hash) {
  File file = read_file(path, hash);
  const Entry* scene = parse_yaml((const char*)file.data, file.size, path);
  require_known(scene, " obstacles name allowed states limits attach ", path);
  const Entry* obstacles = named_entries(section(scene, "obstacles", true, path), path);
  const Entry* attach = named_entries(section(scene, "attach", true, path), path);
  inputs->allowed = section(scene, "allowed", false, path);
  inputs->limits = section(scene, "limits", false, path);
  inputs->obstacles = take(size_of(obstacles) + 1, sizeof *inputs->obstacles);
  inputs->attached = take(size_of(attach) + 1, sizeof *inputs->attached);
  for (const Entry* each = obstacles->child; each; each = each->next) {
    Shape shape = shape_of(each, "clearance ", path, each->key, hash);
    if (obstacle_named(inputs, each->key) != NONE) fail(BAD_INPUT, "%s: two of one name: %.60s", path, each->key);
    inputs->obstacles[inputs->obstacle_count++] = (Obstacle){each->key, shape};
  }
  for (const Entry* each = inputs->allowed ? inputs->allowed->child : NULL; each; each = each->next) {
    if (obstacle_named(inputs, each->key) == NONE)
      fail(BAD_INPUT, "allowed contact with no obstacle: %.60s", each->key);
    require_texts(each, each->key);
  }
  for (const Entry* each = attach->child; each; each = each->next) {
    read_attached(inputs, each, path, hash);
  }
}
