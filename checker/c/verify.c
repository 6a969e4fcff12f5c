#include "verify.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proof.h"
#include "solids.h"

Inputs* read_inputs(Given given, const Certificate* certificate) {
  Inputs* inputs = take(1, sizeof *inputs);
  Files files = {.packages = given.packages, .package_count = given.package_count};
  const char *own[] = {certificate->robot, certificate->scene}, *paths[] = {given.robot, given.scene};
  files.carried = certificate->carried;
  files.left = certificate->carried_size;
  files.taken = take(certificate->carried_count, sizeof *files.taken);
  sha256_begin(&files.hash);
  for (int i = 0; i < 2; ++i) {
    files.own = own[i] != NULL;
    if (!own[i] && !paths[i]) fail(BAD_INPUT, "the certificate carries no %s: give its file", i ? "scene" : "robot");
    if (own[i] && paths[i] && strcmp(digest_of(read_file(paths[i])), own[i]) != 0) {
      fail(REFUSED, "it carries what it is about, and that was not read from %.200s: write - in its place", paths[i]);
    }
    if (i) read_scene(inputs, own[i] ? "scene.yaml" : paths[i], &files);
    if (!i) read_robot(inputs, own[i] ? "robot.urdf" : paths[i], own[i] ? "robot.srdf" : given.srdf, &files);
  }
  if (files.left) fail(REFUSED, "it carries more files than it needs");
  sha256_end(&files.hash, inputs->digest);
  inputs->carried = files.taken;
  inputs->carried_count = files.taken_count;
  return inputs;
}

Proved verify(const Inputs* inputs, const Certificate* certificate) {
  if (memcmp(certificate->digest, inputs->digest, sizeof inputs->digest) != 0) {
    fail(REFUSED, "robot, SRDF, scene or meshes are not the files that it was written for");
  }
  Model* model = model_of(inputs, certificate);
  Proved proved = {.model = model, .smallest = prove(model)};
  proved.opened = require_outside(model);
  return proved;
}

/* A list after its title, with commas; nothing if it is empty. */
static void print_item(const char* title, const char* item, bool* begun) {
  printf(*begun ? ", %s" : "  %s: %s", *begun ? item : title, item);
  *begun = true;
}

static void end_list(bool begun) {
  if (begun) printf("\n");
}

/* Print what no pair of the proof speaks of. */
/* On which conditions all that is proved is so. */
static void print_conditions(const Model* model) {
  bool begun = false;
  for (size_t i = 0; i < model->certificate->held_count; ++i) {
    char value[32];
    snprintf(value, sizeof value, " %g", model->certificate->held[i].value);
    const char* item = joined(model->certificate->held[i].name, value, "");
    print_item("that other joints are where they are held", item, &begun);
  }
  if (!begun) printf("  that other joints are where they are held: at 0");
  printf("\n");
  const Certificate* certificate = model->certificate;
  if (certificate->robot || certificate->scene) {
    printf("  that what the certificate carries is the robot, or the scene, that is meant: %s%s%s\n",
           certificate->robot ? "robot" : "", certificate->robot && certificate->scene ? ", " : "",
           certificate->scene ? "scene" : "");
  }
  printf("  that the robot is built, calibrated, placed and controlled as the files say: and when it is where\n");
}

static void print_not_claimed(const Model* model) {
  const Inputs* inputs = model->inputs;
  bool begun = false;
  printf("not claimed:\n");
  for (size_t i = 0, body = 0; i < inputs->link_count; ++i) {
    size_t link = model->order[i];
    if (body < model->body_count && model->bodies[body].link == link && model->bodies[body].attached == NONE) {
      ++body;
    } else {
      print_item("links without collision shapes", inputs->links[link].name, &begun);
    }
  }
  end_list(begun);
  begun = false;
  for (size_t i = 0; i < model->body_count; ++i) {
    const Body* body = model->bodies + i;
    if (!body->frame) print_item("links that no joint of the path moves, with obstacles", body->name, &begun);
  }
  end_list(begun);
  printf("  links that are fixed to each other: with each other\n");
  if (inputs->disabled_count) {
    printf("  pairs of links: %zu that the SRDF disables\n", inputs->disabled_count);
  } else {
    printf("  pairs of links: neighbours, as no SRDF disables any\n");
  }
  begun = false;
  for (size_t i = 0; i < inputs->allowed_count; ++i) {
    print_item("allowed contacts", joined(inputs->allowed[i].obstacle, " with ", inputs->allowed[i].body), &begun);
  }
  end_list(begun);
  print_conditions(model);
}

static void print_distances(const Certificate* certificate) {
  if (certificate->clearance > 0) printf(", %g m from all obstacles", certificate->clearance);
  for (size_t i = 0; i < certificate->padding_count; ++i) {
    printf(", %s %g m more", certificate->padding[i].name, certificate->padding[i].value);
  }
  printf("\n");
}

static void print_vector(const char* before, Vector a) { printf("%s(%.6g, %.6g, %.6g)", before, a.x, a.y, a.z); }

static void print_kept(const Kept* kept) {
  const double* q = kept->xyzw;
  print_vector(kept->is_axis ? "  the axis " : "  the point ", kept->part);
  printf(" of %s is within %g %s of ", kept->link, kept->within, kept->is_axis ? "rad" : "m");
  print_vector(kept->is_axis ? "" : "the box ", kept->low);
  if (!kept->is_axis) print_vector(" to ", kept->high);
  if (!kept->is_axis) printf(", turned by the quaternion (%.6g, %.6g, %.6g, %.6g)", q[0], q[1], q[2], q[3]);
  printf("\n");
}

static void print_pairs(const Proved* proved) {
  const Model* model = proved->model;
  printf("pairs proved apart (%zu):\n", model->pair_count);
  for (size_t i = 0; i < model->pair_count; ++i) {
    const Pair* pair = model->pairs + i;
    printf("  %s", model->bodies[pair->a].name);
    for (size_t k = pair->a + 1; pair->b == NONE && k < model->body_count; ++k) {
      if (model->group[k] == pair->a) printf(" and %s", model->bodies[k].name);
    }
    printf(" - %s\n", pair->b == NONE ? "the obstacles" : model->bodies[pair->b].name);
  }
  if (model->certificate->of_pairs) {
    printf("not claimed:\n  pairs that are not listed\n");
    print_conditions(model);
  } else {
    print_not_claimed(model);
  }
  if (proved->opened) printf("  what is inside of surfaces with holes: %zu\n", proved->opened);
}

void print_never(const Proved* proved) {
  const Model* model = proved->model;
  size_t joints = model->certificate->joint_count;
  printf("PROVED: pairs of links never touch, whatever the joints do\n");
  for (size_t i = 0; i < joints; ++i) {
    double low = model->extremes[i], high = model->extremes[joints + i];
    printf("  %s: from %.6g to %.6g\n", model->certificate->joints[i], low, high);
  }
  printf("  smallest gap of a step of the proof: %.3g m\n", proved->smallest);
  print_pairs(proved);
}

void print_proved(const Proved* proved, bool timed) {
  const Model* model = proved->model;
  const Certificate* certificate = model->certificate;
  size_t last = (certificate->points - 1) * certificate->joint_count;
  printf("PROVED: %zu %s touch nothing", certificate->motions,
         is_straight(certificate) ? "straight motions" : "curves");
  print_distances(certificate);
  for (size_t i = 0; timed && i < certificate->limit_count; ++i) {
    const Limit* limit = certificate->limits + i;
    printf("  %s: at most %.6g per second and %.6g per second^2, from rest to rest\n", limit->name, limit->velocity,
           limit->acceleration);
  }
  for (size_t i = 0; i < certificate->joint_count; ++i) {
    double from = certificate->values[i], to = certificate->values[last + i];
    printf("  %s: from %.6g to %.6g\n", certificate->joints[i], from, to);
  }
  printf("  smallest gap of a step of the proof: %.3g m\n", proved->smallest);
  for (size_t i = 0; i < certificate->kept_count; ++i) print_kept(certificate->kept + i);
  if (certificate->tolerance > 0) {
    printf("  joints may be %g off the curves, by the root of the sum of squares\n", certificate->tolerance);
  }
  print_pairs(proved);
  if (certificate->limit_count && !timed) {
    printf("  limits of velocity and acceleration: the table that has the times is not given\n");
  }
}

static void print_pose(const PoseGoal* goal) {
  const double* q = goal->xyzw;
  printf("  goal: %s within %g m of ", goal->link, goal->near);
  print_vector("", goal->pose.at);
  if (goal->turned) {
    printf(", turned by the quaternion (%.6g, %.6g, %.6g, %.6g) within %g rad", q[0], q[1], q[2], q[3], goal->tilt);
  }
  printf(", however the joints reach it\n");
}

void print_no_path(const NoPath* shown) {
  const Model* model = shown->model;
  const Certificate* certificate = model->certificate;
  size_t pairs = 0;
  printf("PROVED: no path leads from the start to any goal: each one touches something");
  print_distances(certificate);
  if (certificate->goals) printf("  goals: %zu configurations\n", certificate->goals);
  for (size_t i = 0; i < certificate->pose_count; ++i) print_pose(certificate->poses + i);
  for (size_t i = 0; i < certificate->joint_count; ++i) {
    printf("  %s: from %.6g", certificate->joints[i], certificate->values[i]);
    for (size_t goal = 1; goal <= certificate->goals; ++goal) {
      printf(" %s %.6g", goal == 1 ? "to" : "or", certificate->values[goal * certificate->joint_count + i]);
    }
    printf("\n");
  }
  bool begun = false;
  for (size_t i = 0; i < certificate->joint_count; ++i) {
    if (shown->columns[i]) print_item("whatever other joints than these do", certificate->joints[i], &begun);
  }
  end_list(begun);
  printf("  %zu cells are blocked; smallest overlap of a cell: %.3g m\n", shown->blocked, shown->smallest);
  for (size_t i = 0; i < certificate->witness_count; ++i) pairs += !shown->witnesses[i].repeats;
  printf("pairs that block the way (%zu):\n", pairs);
  for (size_t i = 0; i < certificate->witness_count; ++i) {
    const Witness* witness = shown->witnesses + i;
    const char *first = model->bodies[witness->ball->body].name, *second = model->bodies[witness->body].name;
    if (!witness->repeats) printf("  %s - %s\n", first, second);
  }
  print_not_claimed(model);
}
