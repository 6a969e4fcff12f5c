#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "inputs.h"

const char* const kind_names[KINDS] = {"box", "sphere", "cylinder", "capsule", "mesh", "plane", "cloud"};

/* Refuse keys that are not among those in `known`, each after a blank. */
static void require_known(const Entry* mapping, const char* known, const char* where) {
  if (mapping->kind != MAPPING) fail(BAD_INPUT, "%s: no mapping", where);
  for (const Entry* each = mapping->child; each; each = each->next) {
    const char* found = strstr(known, joined(" ", each->key, " "));
    if (!found || strchr(each->key, ' ')) fail(BAD_INPUT, "%s: a key that is not read: %.60s", where, each->key);
  }
}

static bool is_true(const Entry* mapping, const char* key, const char* where) {
  const char* text = text_of(mapping, key, "false");
  bool yes = !strcmp(text, "true");
  if (!yes && strcmp(text, "false") != 0) fail(BAD_INPUT, "%s: %s must be true or false", where, key);
  return yes;
}

static const char* file_of(const Entry* entry, const char* scene, const char* where) {
  const char* name = required(entry, "file", where);
  return joined(*name == '/' ? "" : folder_of(scene), name, "");
}

static Mesh* mesh_of(const Entry* entry, const char* scene, const char* where, bool convex, Files* files) {
  double scale[3] = {1, 1, 1};
  const Entry* given = child_of(entry, "scale");
  bool one = given && given->kind == SCALAR;
  numbers_of(entry, "scale", scale, one ? 1 : 3, where);
  if (one) scale[1] = scale[2] = scale[0];
  const char* path = file_of(entry, scene, where);
  return read_mesh(next_file(files, path), path, scale, convex);
}

/* The points of a cloud: three numbers a line. */
static Mesh* cloud_of(const Entry* entry, const char* scene, const char* where, Files* files) {
  Mesh* cloud = take(1, sizeof *cloud);
  const char* path = file_of(entry, scene, where);
  File file = next_file(files, path);
  size_t lines = 1;
  for (size_t i = 0; i < file.size; ++i) lines += file.data[i] == '\n';
  cloud->points = take(lines, sizeof *cloud->points);
  const char* line = (const char*)file.data;
  while (*line) {
    double xyz[3];
    size_t size = strcspn(line, "\n");
    read_numbers(copied(line, size), xyz, 3, path);
    cloud->points[cloud->point_count++] = (Vector){xyz[0], xyz[1], xyz[2]};
    line += size + (line[size] == '\n');
  }
  if (line != (const char*)file.data + file.size || !cloud->point_count) fail(BAD_INPUT, "%s: no points", path);
  return cloud;
}

static Pose pose_of(const Entry* entry, const char* where) {
  double xyz[3] = {0, 0, 0}, rpy[3] = {0, 0, 0}, xyzw[4] = {0, 0, 0, 1};
  numbers_of(entry, "xyz", xyz, 3, where);
  Vector at = {xyz[0], xyz[1], xyz[2]};
  bool angles = numbers_of(entry, "rpy", rpy, 3, where), quaternion = numbers_of(entry, "xyzw", xyzw, 4, where);
  if (angles && quaternion) fail(BAD_INPUT, "%s: both rpy and xyzw", where);
  return quaternion ? pose_of_quaternion(xyzw, at) : pose_of_angles(rpy, at);
}

/* Spell out `box: {size: ...}` and `sphere: 0.1` as `shape: box, size: ...`. */
static void spell_out(Entry* entry, const char* path) {
  for (int kind = BOX; kind < MESH && !child_of(entry, "shape"); ++kind) {
    Entry* found = child_of(entry, kind_names[kind]);
    if (!found) continue;
    if (found->kind == MAPPING && found->child) {
      entry->last->next = found->child;
      entry->last = found->last;
    } else {
      append(entry, "radius", found->text, found->kind);
    }
    *found = (Entry){.key = "shape", .text = kind_names[kind], .kind = SCALAR, .next = found->next};
  }
  refuse_equal_keys(entry, path);
}

static Shape shape_of(Entry* entry, const char* more, const char* scene, Files* files) {
  static const char* const own[] = {
      " size ", " radius ", " radius length ", " radius length ", " file scale convex ", " ", " file radius "};
  static const char* const keys[] = {"size", "radius", "length"};
  Shape shape = {0};
  const char* where = entry->key;
  if (entry->kind != MAPPING) fail(BAD_INPUT, "%s: no mapping", where);
  spell_out(entry, scene);
  const char* kind = text_of(entry, "shape", "");
  while (shape.kind < KINDS && strcmp(kind_names[shape.kind], kind) != 0) ++shape.kind;
  if (shape.kind == KINDS) fail(BAD_INPUT, "%s: a shape that is not read: %.60s", where, kind);
  require_known(entry, joined(own[shape.kind], "shape xyz rpy xyzw cell clearance ", more), where);
  if (shape.kind == MESH) {
    shape.convex = is_true(entry, "convex", where);
    shape.mesh = mesh_of(entry, scene, where, shape.convex, files);
  } else if (shape.kind == CLOUD) {
    shape.mesh = cloud_of(entry, scene, where, files);
    shape.size[0] = 0.01;
    numbers_of(entry, "radius", shape.size, 1, where);
    if (!(shape.size[0] > 0)) fail(BAD_INPUT, "%s: no radius", where);
  } else if (shape.kind != PLANE && !read_size(&shape, entry, keys, where)) {
    fail(BAD_INPUT, "%s: no size", where);
  }
  shape.pose = pose_of(entry, where);
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

/* A part of a scene, of entries with names: a mapping, or a list whose entries say their names. */
static Entry* section(Entry* scene, const char* key, const char* path) {
  static Entry nothing;
  Entry* found = child_of(scene, key);
  if (!found || (found->kind == SCALAR && !*found->text)) return &nothing;
  if (found->kind == SCALAR) fail(BAD_INPUT, "%s: %s is no mapping", path, key);
  size_t i = 0;
  for (Entry* each = found->child; found->kind == LIST && each; each = each->next, ++i) {
    char number[32];
    snprintf(number, sizeof number, " %zu", i);
    each->key = text_of(each, "name", joined(text_of(each, "shape", "None"), number, ""));
  }
  if (found->kind == LIST) refuse_equal_keys(found, path);
  return found;
}

static size_t size_of(const Entry* entry) {
  size_t count = 0;
  for (const Entry* each = entry->child; each; each = each->next) ++count;
  return count;
}

static void require_texts(const Entry* list, const char* where) {
  bool texts = list->kind == LIST;
  for (const Entry* each = list->child; each; each = each->next) texts = texts && each->kind == SCALAR;
  if (!texts) fail(BAD_INPUT, "%s: no list of names; contacts with parts are not read", where);
}

static int by_names(const void* a, const void* b) {
  const Contact *p = a, *q = b;
  int order = strcmp(p->obstacle, q->obstacle);
  return order ? order : strcmp(p->body, q->body);
}

/* Gather what may touch: each once, sorted. */
static void read_allowed(Inputs* inputs, const Entry* allowed) {
  size_t room = 1, count = 0;
  for (const Entry* each = allowed->child; each; each = each->next) {
    if (obstacle_named(inputs, each->key) == NONE)
      fail(BAD_INPUT, "allowed contact with no obstacle: %.60s", each->key);
    require_texts(each, each->key);
    room += size_of(each);
  }
  for (size_t i = 0; i < inputs->attached_count; ++i) {
    const Entry* touches = inputs->attached[i].touches;
    room += touches ? size_of(touches) : 0;
  }
  Contact* contacts = inputs->allowed = take(room, sizeof *contacts);
  for (const Entry* each = allowed->child; each; each = each->next) {
    for (const Entry* link = each->child; link; link = link->next) contacts[count++] = (Contact){each->key, link->text};
  }
  for (size_t i = 0; i < inputs->attached_count; ++i) {
    const Link* attached = inputs->attached + i;
    for (const Entry* each = attached->touches ? attached->touches->child : NULL; each; each = each->next) {
      if (obstacle_named(inputs, each->text) != NONE) contacts[count++] = (Contact){each->text, attached->name};
    }
  }
  qsort(contacts, count, sizeof *contacts, by_names);
  for (size_t i = 0; i < count; ++i) {
    size_t last = inputs->allowed_count;
    if (!last || by_names(contacts + last - 1, contacts + i)) contacts[inputs->allowed_count++] = contacts[i];
  }
}

static Link attached_of(const Inputs* inputs, Entry* entry, const char* more, const char* path, Files* files) {
  Link attached = {.name = entry->key, .count = 1, .shapes = take(1, sizeof(Shape))};
  attached.shapes[0] = shape_of(entry, joined("link touches ", more, ""), path, files);
  attached.touches = child_of(entry, "touches");
  if (attached.touches) require_texts(attached.touches, entry->key);
  attached.link = link_named(inputs, text_of(entry, "link", ""));
  if (attached.link == NONE) fail(BAD_INPUT, "%.60s is attached to no link", entry->key);
  if (link_named(inputs, entry->key) != NONE) fail(BAD_INPUT, "%.60s is a link", entry->key);
  return attached;
}

void read_scene(Inputs* inputs, const char* path, Files* files) {
  File file = next_file(files, path);
  Entry* scene = parse_yaml((const char*)file.data, file.size, path);
  require_known(scene, " obstacles name allowed states limits attach ", path);
  Entry *obstacles = section(scene, "obstacles", path), *attach = section(scene, "attach", path);
  inputs->obstacles = take(size_of(obstacles) + 1, sizeof *inputs->obstacles);
  inputs->attached = take(size_of(attach) + 1, sizeof *inputs->attached);
  for (Entry* each = obstacles->child; each; each = each->next) {
    Shape shape = shape_of(each, obstacles->kind == LIST ? "name " : "", path, files);
    inputs->obstacles[inputs->obstacle_count++] = (Obstacle){each->key, shape};
  }
  for (Entry* each = attach->child; each; each = each->next) {
    Link attached = attached_of(inputs, each, attach->kind == LIST ? "name " : "", path, files);
    inputs->attached[inputs->attached_count++] = attached;
  }
  read_allowed(inputs, section(scene, "allowed", path));
  inputs->limits = section(scene, "limits", path);
}
