#include "tests/e2e/process_memory.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static FILE *open_of(pid_t pid, const char *name)
{
    char path[64];
    (void)snprintf(path, sizeof path, "/proc/%d/%s", (int)pid, name);
    return fopen(path, "re");
}

/* Whether a line of maps describes an area that the process may read and write. */
static bool is_own(const char *line, unsigned long *from, unsigned long *to)
{
    char rights[5] = "";
    return sscanf(line, "%lx-%lx %4s", from, to, rights) == 3 && rights[0] == 'r' &&
           rights[1] == 'w';
}

static void append(struct process_memory *memory, int fd, unsigned long from, unsigned long to)
{
    unsigned char *bytes = realloc(memory->bytes, memory->size + (to - from));
    assert_non_null(bytes);
    memory->bytes = bytes;
    for (unsigned long at = from; at < to;) {
        const ssize_t n = pread(fd, bytes + memory->size, to - at, (off_t)at);
        if (n <= 0) {
            break; /* a page that was never used */
        }
        memory->size += (size_t)n;
        at += (unsigned long)n;
    }
}

static void append_area(struct process_memory *memory, const char *line, size_t offset)
{
    struct process_memory_area *areas = reallocarray(memory->areas, memory->n_areas + 1,
                                                     sizeof *areas);
    assert_non_null(areas);
    memory->areas = areas;
    struct process_memory_area *area = &areas[memory->n_areas++];
    (void)snprintf(area->line, sizeof area->line, "%.*s", (int)strcspn(line, "\n"), line);
    area->offset = offset;
    area->size = memory->size - offset;
}

static void read_areas(FILE *maps, FILE *mem, struct process_memory *out)
{
    char line[1024];
    unsigned long from, to;
    while (fgets(line, sizeof line, maps)) {
        if (is_own(line, &from, &to)) {
            const size_t offset = out->size;
            append(out, fileno(mem), from, to);
            append_area(out, line, offset);
        }
    }
}

bool process_memory_read(pid_t pid, struct process_memory *out)
{
    *out = (struct process_memory){.bytes = NULL};
    FILE *maps = open_of(pid, "maps");
    FILE *mem = maps ? open_of(pid, "mem") : NULL;
    if (!mem) {
        assert_true(errno == EACCES || errno == EPERM);
        if (maps) {
            fclose(maps);
        }
        return false;
    }
    int status = 0;
    assert_int_equal(kill(pid, SIGSTOP), 0);
    assert_int_equal(waitpid(pid, &status, WUNTRACED), pid);
    assert_true(WIFSTOPPED(status));
    read_areas(maps, mem, out);
    assert_int_equal(kill(pid, SIGCONT), 0);
    fclose(maps);
    fclose(mem);
    assert_true(out->size > 1 << 20);
    return true;
}

void process_memory_free(struct process_memory *memory)
{
    free(memory->bytes);
    free(memory->areas);
    *memory = (struct process_memory){.bytes = NULL};
}

/* Prints where the bytes are, with 48 bytes before and after them. */
static void print_place(const struct process_memory *memory, size_t offset, size_t size)
{
    enum { AROUND = 48 };
    size_t i = 0;
    while (i + 1 < memory->n_areas && memory->areas[i + 1].offset <= offset) {
        i++;
    }
    const struct process_memory_area *area = &memory->areas[i];
    const size_t in_area = offset - area->offset;
    const size_t from = in_area < AROUND ? 0 : in_area - AROUND;
    const size_t end = in_area + size + AROUND < area->size ? in_area + size + AROUND : area->size;
    print_message("  %s + %#zx of %#zx: ", area->line, in_area, area->size);
    for (size_t k = from; k < end; k++) {
        const int byte = memory->bytes[area->offset + k];
        print_message(byte > ' ' && byte < 0x7f ? "%c" : "\\%02x", byte);
    }
    print_message("\n");
}

int process_memory_count(const struct process_memory *memory, const void *bytes, size_t size,
                         bool print)
{
    int n = 0;
    const unsigned char *at = memory->bytes, *end = memory->bytes + memory->size;
    while ((at = memmem(at, (size_t)(end - at), bytes, size))) {
        if (print) {
            print_place(memory, (size_t)(at - memory->bytes), size);
        }
        n++;
        at += size;
    }
    return n;
}
