#include "sim/file_bytes.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Reads to the end, into memory that grows with what comes: a pipe does not know its size. */
static int read_all(FILE *file, size_t max_bytes, char **bytes, size_t *size)
{
    char *buffer = NULL;
    size_t capacity = 0, n = 0;
    do {
        capacity = 2 * capacity + 65536;
        capacity = capacity > max_bytes + 2 ? max_bytes + 2 : capacity;
        char *grown = realloc(buffer, capacity);
        if (!grown) {
            free(buffer);
            return -ENOMEM;
        }
        buffer = grown;
        n += fread(buffer + n, 1, capacity - 1 - n, file);
    } while (n == capacity - 1 && n <= max_bytes);
    int error = ferror(file) ? -EIO : n > max_bytes ? -EFBIG : 0;
    if (error) {
        free(buffer);
        return error;
    }
    buffer[n] = '\0';
    *bytes = buffer;
    *size = n;
    return 0;
}

int sim_file_bytes(const char *path, size_t max_bytes, char **bytes, size_t *size,
                   struct iso_fault *fault)
{
    FILE *file = fopen(path, "rbe");
    if (!file) {
        return iso_fault_set(fault, -errno, "%s: %s", path, strerror(errno));
    }
    int error = read_all(file, max_bytes, bytes, size);
    (void)fclose(file);
    return error == -EFBIG
               ? iso_fault_set(fault, error, "%s: larger than %zu bytes", path, max_bytes)
           : error ? iso_fault_set(fault, error, "%s: %s", path, strerror(-error))
                   : 0;
}
