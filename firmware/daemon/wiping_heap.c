/* Overwrites freed memory with zeros. libsystemd, SQLite, stdio and our own code copy names and
 * templates into buffers on the heap. Without this file, the data would remain in the memory of the
 * process after a buffer is freed, and an attacker who can read this memory would find it.
 *
 * This file defines malloc(), free(), realloc() and the other functions of the heap. A program that
 * is linked with it uses them instead of those of the C library, and so does every library that the
 * program loads. They get their memory from the C library; free() wipes a block before it returns
 * it. When a block has to grow, realloc() copies it to a new address and wipes the old block. It
 * takes about 0.1 ms to wipe one megabyte. Our own code allocates no memory while it processes a
 * frame.
 *
 * Sanitizers have a heap of their own, which this file must not replace. With them the file is
 * empty, and freed memory is not wiped. */
#ifdef ISOTHERM_SANITIZED

typedef int iso_wiping_heap_is_left_out;

#else

#include <errno.h>
#include <malloc.h>
#include <stdlib.h>
#include <string.h>

/* The C library's own functions, under the names that it keeps for programs which replace them. */
// NOLINTBEGIN(bugprone-reserved-identifier)
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t n, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);
extern void *__libc_valloc(size_t size);
extern void *__libc_pvalloc(size_t size);
extern void *__libc_realloc(void *memory, size_t size);
extern void __libc_free(void *memory);
// NOLINTEND(bugprone-reserved-identifier)

/* The other functions of the set are unchanged. They are defined here because free() must not get
 * memory of another heap, such as that of a library which is loaded before all others. */

void *malloc(size_t size)
{
    return __libc_malloc(size);
}

void *calloc(size_t n, size_t size)
{
    return __libc_calloc(n, size);
}

void *memalign(size_t alignment, size_t size)
{
    return __libc_memalign(alignment, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return __libc_memalign(alignment, size);
}

void *valloc(size_t size)
{
    return __libc_valloc(size);
}

void *pvalloc(size_t size)
{
    return __libc_pvalloc(size);
}

int posix_memalign(void **memory, size_t alignment, size_t size)
{
    const int before = errno;
    if (alignment % sizeof(void *) != 0 || alignment == 0 || (alignment & (alignment - 1)) != 0) {
        return EINVAL;
    }
    void *got = __libc_memalign(alignment, size);
    errno = before;
    if (!got) {
        return ENOMEM;
    }
    *memory = got;
    return 0;
}

void free(void *memory)
{
    if (memory) {
        const int error = errno;
        explicit_bzero(memory, malloc_usable_size(memory));
        __libc_free(memory);
        errno = error;
    }
}

void *realloc(void *memory, size_t size)
{
    if (!memory) {
        return __libc_realloc(NULL, size);
    }
    if (size == 0) {
        free(memory);
        return NULL;
    }
    const size_t old = malloc_usable_size(memory);
    if (size <= old && size >= old / 2) {
        /* The memory can stay where it is. */
        return memory;
    }
    void *moved = malloc(size);
    if (moved) {
        memcpy(moved, memory, old < size ? old : size);
        free(memory);
    }
    return moved;
}

#endif
