/* Files of the project as text, for tests that compare one with another. */
#ifndef TEST_READ_TEXT_H
#define TEST_READ_TEXT_H

/* The whole file as a string, to be freed. Fails the running test if there is none. */
char *read_text(const char *path);

#endif
