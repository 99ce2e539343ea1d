#include "drivers/terminal/output.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

int iso_output_end(const char *program)
{
    errno = 0;
    const int flushed = fflush(stdout);

    if (flushed == 0 && !ferror(stdout)) {
        return 0;
    }
    const int error = flushed != 0 && errno ? errno : EIO;
    /* If an earlier print failed, its errno is no longer known. */
    fprintf(stderr, "%s: standard output: %s\n", program,
            flushed != 0 ? strerror(error) : "cannot be written");
    return -error;
}
