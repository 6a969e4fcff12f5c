/* evenroad-verify in C: checks that a certificate proves a robot's path free of collision, as docs/certificates.md
 * says. */
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "verify.h"

static const char USAGE[] =
    "usage: evenroad-verify [--package NAME=FOLDER] [--path CSV] [--start VALUES] [--goal VALUES] [--write FOLDER]\n"
    "                       certificate [robot] [scene] [srdf]\n"
    "Check that a path is proved free of contact: 0 if it is, 1 if the certificate is refused, 2 for bad input.\n"
    "- or no robot or scene: the one that the certificate carries, which --write writes.\n"
    "--path is the table, --start and --goal the values of the joints, that must be what is proved.\n";

enum { MOST_PACKAGES = 64 };

/* What is asked for; set before anything can fail. */
typedef struct {
  const char *certificate, *path, *start, *goal, *folder, *package, *packages[MOST_PACKAGES];
  Given given;
} Asked;

/* Read the command line; false if it is none. */
static bool understood(int count, char** words, Asked* asked) {
  const char** files[] = {&asked->certificate, &asked->given.robot, &asked->given.scene, &asked->given.srdf};
  const char* const names[] = {"--package", "--path", "--start", "--goal", "--write"};
  const char** options[] = {&asked->package, &asked->path, &asked->start, &asked->goal, &asked->folder};
  size_t taken = 0, known = sizeof names / sizeof *names;
  for (int i = 1; i < count; ++i) {
    size_t option = 0;
    bool none = !strcmp(words[i], "-");
    while (option < known && strcmp(words[i], names[option]) != 0) ++option;
    if (option < known) {
      if (++i == count || (option == 0 && asked->given.package_count == MOST_PACKAGES)) return false;
      *options[option] = words[i];
      if (option == 0) asked->packages[asked->given.package_count++] = words[i];
    } else if (taken == 4 || (words[i][0] == '-' && !none)) {
      return false;
    } else {
      *files[taken++] = none ? NULL : words[i];
    }
  }
  asked->given.packages = asked->packages;
  return asked->certificate != NULL;
}

static void check(const Asked* asked) {
  const Certificate* certificate = read_certificate(read_file(asked->certificate));
  const Inputs* inputs = read_inputs(asked->given, certificate);
  bool of_none = certificate->of_no_path;
  NoPath shown = {0};
  Proved proved = {0};
  if (of_none) {
    shown = verify_no_path(inputs, certificate);
  } else {
    proved = verify(inputs, certificate);
  }
  if (asked->path && (of_none || certificate->of_pairs)) fail(REFUSED, "it is about no path");
  if (asked->path) require_same_path(certificate, asked->path);
  size_t points = certificate->points, last = points ? points - 1 : 0;
  require_end(certificate, "start", asked->start, 0, points > 0);
  require_end(certificate, "goal", asked->goal, of_none ? 1 : last, of_none ? last : points > 0);
  if (asked->folder) write_files(asked->folder, inputs->carried, inputs->carried_count);
  if (of_none) {
    print_no_path(&shown);
  } else if (certificate->of_pairs) {
    print_never(&proved);
  } else {
    print_proved(&proved, asked->path != NULL);
  }
}

int main(int count, char** words) {
  static Asked asked;
  if (!understood(count, words, &asked)) {
    fputs(USAGE, stderr);
    return BAD_INPUT;
  }
#ifdef SIGPIPE
  signal(SIGPIPE, SIG_IGN); /* `head` closes the output early: the exit code stays the answer */
#endif
  int code = setjmp(on_failure);
  if (code == REFUSED) printf("REFUSED: %s\n", failure);
  if (code == BAD_INPUT) fprintf(stderr, "evenroad-verify: %s\n", failure);
  if (!code) check(&asked);
  release(NULL);
  return code;
}
