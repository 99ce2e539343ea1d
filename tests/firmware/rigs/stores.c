#include "tests/firmware/rigs/stores.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/rigs/puppets.h"
#include "tests/support/scratch.h"

static struct iso_key_ring *ring;

struct iso_key_ring *stores_ring(const char *directory)
{
    const struct iso_key_place place = {.ring = scratch_path(directory, "g.db.keys"),
                                        .file = scratch_path(directory, "g.db.key")};
    struct iso_fault fault = {.text = ""};
    if (!ring && iso_key_ring_open(&place, &ring, &fault)) {
        fail_msg("%s", fault.text);
    }
    return ring;
}

void stores_forget(void)
{
    iso_key_ring_close(ring);
    ring = NULL;
}

int stores_setup(void **state)
{
    return scratch_setup(state);
}

int stores_teardown(void **state)
{
    stores_forget();
    return scratch_teardown(state);
}

struct iso_gallery_options stores_gallery(const char *directory)
{
    return (struct iso_gallery_options){
        .path = scratch_path(directory, "g.db"),
        .capacity = 3,
        .algorithm = PUPPET_ALGORITHM,
        .ring = stores_ring(directory),
        .migrate = true,
    };
}

struct iso_audit_options stores_audit(const char *directory)
{
    return (struct iso_audit_options){
        .path = scratch_path(directory, "a.log"),
        .sync = true,
        .migrate = true,
        .ring = stores_ring(directory),
    };
}

static int print_line(void *context, const char *line)
{
    return fprintf(context, "%s\n", line) < 0 ? -1 : 0;
}

char *stores_log_text(struct iso_audit *audit)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    assert_int_equal(iso_audit_read(audit, 1, UINT32_MAX, print_line, out), 0);
    assert_int_equal(fclose(out), 0);
    return text;
}

void stores_copy_file(const char *directory, const char *from, const char *to)
{
    size_t size = 0;
    void *bytes = scratch_read(scratch_path(directory, from), &size);
    scratch_write(scratch_path(directory, to), bytes, size);
    free(bytes);
}
