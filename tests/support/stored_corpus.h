/* Makes small corpora from the recordings of sim/stored, for tests of code that reads corpora. */
#ifndef TESTS_SUPPORT_STORED_CORPUS_H
#define TESTS_SUPPORT_STORED_CORPUS_H

/* The first line of a manifest. */
#define STORED_CORPUS_HEADER "recording,first,count,subject,session,role,pose,expression,note\n"

/* Writes a manifest into an existing directory, and makes links there to the recordings of
 * sim/stored that its rows name. Failures fail the running cmocka test. */
void stored_corpus_make(const char *directory, const char *manifest);

#endif
