/* The fingerprint of the web server's certificate (isotherm-web(8)), which the screen shows while
 * nobody is there: whoever opens the pages compares it with what the browser says. On an image the
 * screen also shows the code for the first account, as long as there is none. Both come from files
 * that the web server writes, and that the screen trusts with nothing: only a text of the form of a
 * fingerprint, or of a code, is shown. */
#ifndef ENROLL_SCREEN_FINGERPRINT_H
#define ENROLL_SCREEN_FINGERPRINT_H

#include <stdint.h>

enum { SCREEN_FINGERPRINT_SIZE = 95 + 1 }; /* 32 bytes, "AB:CD:...", with the NUL */

/* The shortest time between two reads of the file, nanoseconds. */
#define SCREEN_FINGERPRINT_NS INT64_C(10000000000)

/* All zero: the file has not been read yet. */
struct screen_fingerprint {
    int64_t next_ns; /* when the file is read again */
    char text[SCREEN_FINGERPRINT_SIZE];
};

/* Returns the fingerprint that the file `path` contains. It reads the file again if the last
 * reading was SCREEN_FINGERPRINT_NS ago; now_ns is the monotonic time. The file has 1 to 95 of the
 * characters 0-9, A-F and ':', and may have a line end after them. The result is "" if the file has
 * anything else, is missing or is no regular file, and if `path` is "". It is valid until the next
 * call. */
const char *screen_fingerprint_look(struct screen_fingerprint *fingerprint, const char *path,
                                    int64_t now_ns);

/* The same for a file with a code of 1 to 95 of the characters 0-9, A-Z and '-'. */
const char *screen_setup_code_look(struct screen_fingerprint *code, const char *path,
                                   int64_t now_ns);

#endif
