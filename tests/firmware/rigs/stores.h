/* Sealed stores in a directory of the test: g.db, a.log, and the key ring for both. */
#ifndef TESTS_FIRMWARE_RIGS_STORES_H
#define TESTS_FIRMWARE_RIGS_STORES_H

#include "firmware/audit/audit.h"
#include "firmware/gallery/gallery.h"
#include "firmware/keys/key_ring.h"

/* The ring of this directory, opened on first use and again after stores_forget(). A failure fails
 * the test. */
struct iso_key_ring *stores_ring(const char *directory);
void stores_forget(void);

/* scratch_setup(), and scratch_teardown() after stores_forget(). */
int stores_setup(void **state);
int stores_teardown(void **state);

/* Options for g.db (3 people, the puppets' algorithm) and a.log (synchronised, one segment). */
struct iso_gallery_options stores_gallery(const char *directory);
struct iso_audit_options stores_audit(const char *directory);

/* Copies a file of the directory: saves it under another name, or restores it. */
void stores_copy_file(const char *directory, const char *from, const char *to);

/* Returns all records of a log, decrypted, one on each line. Free it with free(). */
char *stores_log_text(struct iso_audit *audit);

#endif
