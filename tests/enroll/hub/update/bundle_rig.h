/* A file with the layout of a RAUC bundle of the format "verity": contents, a CMS message that
 * embeds the manifest, its length. The contents are no file system. Failures fail the running
 * cmocka test. */
#ifndef TESTS_ENROLL_HUB_UPDATE_BUNDLE_RIG_H
#define TESTS_ENROLL_HUB_UPDATE_BUNDLE_RIG_H

#include <stddef.h>

/* Writes the file: `size` bytes of contents that depend on `fill`, and the manifest. */
void bundle_rig_write(const char *path, const char *manifest, size_t size, unsigned char fill);

/* The manifest of a version and a board; the text belongs to the rig until the next call. */
const char *bundle_rig_manifest(const char *version, const char *board);

#endif
