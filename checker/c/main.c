/* evenroad-verify in C: checks that a certificate proves a robot's path free of collision, as docs/certificates.md
 * says. */
#include <stdio.h>
#include <string.h>

#include "verify.h"

static const char USAGE[] =
    "usage: evenroad-verify [--package NAME=FOLDER] [--path PATH] certificate [robot] [scene] [srdf]\n"
    "Check that a path is proved free of contact: 0 if it is, 1 if the certificate is refused, 2 for bad input.\n"
    "- or no robot or scene: the one that the certificate carries.\n";

enum { MOST_PACKAGES = 64 };

/* What is asked for; set before anything can fail. */
typedef struct {
  const char *certificate, *path, *packages[MOST_PACKAGES];
  Given given;
} Asked;

/* Read the command line; false if it is none. */
static bool understood(int count, char** words, Asked* asked) {
  const char** files[] = {&asked->certificate, &asked->given.robot, &asked->given.scene, &asked->given.srdf};
  int taken = 0;
  for (int i = 1; i < count; ++i) {
    bool package = !strcmp(words[i], "--package"), path = !strcmp(words[i], "--path"), none = !strcmp(words[i], "-");
    if (package || path) {
      if (++i == count || (package && asked->given.package_count == MOST_PACKAGES)) return false;
      if (path) asked->path = words[i];
      if (package) asked->packages[asked->given.package_count++] = words[i];
    } else if (taken == 4 || (words[i][0] == '-' && !none)) {
      return false;
    } else {
      *files[taken++] = none ? NULL : words[i];
    }
  }
  asked->given.packages = asked->packages;
  return asked->certificate != NULL;
}

int main(int count, char** words) {
  static Asked asked;
  if (!understood(count, words, &asked)) {
    fputs(USAGE, stderr);
    return BAD_INPUT;
  }
  int code = setjmp(on_failure);
  if (code == REFUSED) printf("REFUSED: %s\n", failure);
  if (code == BAD_INPUT) fprintf(stderr, "evenroad-verify: %s\n", failure);
  if (!code) {
    const Certificate* certificate = read_certificate(read_file(asked.certificate));
    const Inputs* inputs = read_inputs(asked.given, certificate);
    if (certificate->of_no_path) {
      NoPath shown = verify_no_path(inputs, certificate);
      if (asked.path) fail(REFUSED, "it proves that there is no path");
      print_no_path(&shown);
    } else {
      Proved proved = verify(inputs, certificate);
      if (asked.path) require_same_path(certificate, asked.path);
      print_proved(&proved);
    }
  }
  release(NULL);
  return code;
}
