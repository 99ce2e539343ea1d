/* What the result of a function of LAPACKE means. */
#ifndef ISO_CORE_BASE_LAPACK_H
#define ISO_CORE_BASE_LAPACK_H

#include <errno.h>
#include <lapacke.h>

/* Converts the result of a function of LAPACKE to an error: 0; -ENOMEM if there was no memory for
 * its work or for a transposed matrix; -EDOM for any other failure, such as a matrix that is not
 * positive definite, or numbers that are not finite. */
static inline int iso_lapack_error(lapack_int result)
{
    if (result == LAPACK_WORK_MEMORY_ERROR || result == LAPACK_TRANSPOSE_MEMORY_ERROR) {
        return -ENOMEM;
    }
    return result ? -EDOM : 0;
}

#endif
