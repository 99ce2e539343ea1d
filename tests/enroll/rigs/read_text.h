/* Reads files of the project as text, for tests that compare one with another. */
#ifndef TEST_READ_TEXT_H
#define TEST_READ_TEXT_H

/* Returns the whole file as a string. Free it with free(). Fails the running test if the file does
 * not exist. */
char *read_text(const char *path);

#endif
