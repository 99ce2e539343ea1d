/* The documents agree with the code: the stages in ARCHITECTURE.md and in the diagram are those of
 * core/extract, and the picture of isotherms is the one that the present code draws. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/file/png.h"
#include "isotherm/extract.h"
#include "tests/support/scratch.h"

enum { NAMES_MAX = 32, NAME_MAX_BYTES = 32 };

struct names {
    int n;
    char name[NAMES_MAX][NAME_MAX_BYTES];
};

/* Returns the text of a file. Free it with free(). */
static char *document(const char *path)
{
    size_t size;
    char *bytes = scratch_read(path, &size);
    char *text = realloc(bytes, size + 1);
    assert_non_null(text);
    text[size] = '\0';
    return text;
}

static void add_name(struct names *names, const char *name, size_t length)
{
    assert_true(names->n < NAMES_MAX);
    assert_true(length > 0 && length < NAME_MAX_BYTES);
    memcpy(names->name[names->n], name, length);
    names->name[names->n++][length] = '\0';
}

/* Asserts that these are the names of all stages, in their order. */
static void assert_stages(const struct names *names)
{
    assert_int_equal(names->n, ISO_STAGES);
    for (int stage = 0; stage < ISO_STAGES; stage++) {
        assert_string_equal(names->name[stage], iso_stage_name((enum iso_stage)stage));
    }
}

/* Reads the first column of the first table after a heading, without the two lines of the table's
 * head. */
static void read_table(char *text, const char *heading, struct names *names)
{
    char *at = strstr(text, heading);
    assert_non_null(at);
    at = strstr(at, "\n| ");
    assert_non_null(at);
    int row = 0;
    for (char *line = at + 1; line[0] == '|'; row++) {
        if (row >= 2) {
            add_name(names, line + 2, strcspn(line + 2, " "));
        }
        line = strchr(line, '\n');
        assert_non_null(line);
        line++;
    }
}

/* Reads the nodes of the diagram's cluster "extract". The first line of each label is the name. */
static void read_nodes(char *text, struct names *names)
{
    char *line = strstr(text, "subgraph cluster_extract {\n");
    assert_non_null(line);
    for (line = strchr(line, '\n') + 1; strncmp(line, "  }", 3) != 0;
         line = strchr(line, '\n') + 1) {
        char name[NAME_MAX_BYTES], label[NAME_MAX_BYTES];
        if (sscanf(line, " %31[a-z] [label=\"%31[a-z]\\n", name, label) == 2) {
            assert_string_equal(label, name);
            add_name(names, name, strlen(name));
        }
    }
}

static void test_the_architecture_lists_the_stages(void **state)
{
    (void)state;
    struct names names = {0};
    char *text = document(ISOTHERM_SOURCE_DIR "/ARCHITECTURE.md");
    read_table(text, "### Stages of the extraction\n", &names);
    free(text);
    assert_stages(&names);
}

static void test_the_diagram_has_the_stages(void **state)
{
    (void)state;
    struct names names = {0};
    char *text = document(ISOTHERM_SOURCE_DIR "/sim/gallery/pipeline.dot");
    read_nodes(text, &names);
    assert_stages(&names);
    for (int stage = 1; stage < ISO_STAGES; stage++) {
        char arrow[2 * NAME_MAX_BYTES + 4];
        (void)snprintf(arrow, sizeof arrow, "%s -> %s", names.name[stage - 1], names.name[stage]);
        assert_non_null(strstr(text, arrow));
    }
    free(text);
}

static void read_picture(const char *path, struct iso_image *image)
{
    const struct iso_png_expectation colours = {.pixels = ISO_PIXEL_RGB8};
    struct iso_fault fault = {.text = ""};
    if (iso_png_read(path, &colours, image, &fault) != 0) {
        fail_msg("%s", fault.text);
    }
}

/* Counts pixels that differ by more than the rounding of compilers and processors explains. */
static size_t count_other_pixels(const struct iso_image *a, const struct iso_image *b)
{
    enum { TOLERANCE = 24 };
    size_t other = 0;
    for (int row = 0; row < a->height_px; row++) {
        const uint8_t *p = (const uint8_t *)a->samples + (size_t)row * iso_image_row_bytes(a);
        const uint8_t *q = (const uint8_t *)b->samples + (size_t)row * iso_image_row_bytes(b);
        for (int column = 0; column < a->width_px; column++, p += 3, q += 3) {
            other += abs(p[0] - q[0]) > TOLERANCE || abs(p[1] - q[1]) > TOLERANCE ||
                     abs(p[2] - q[2]) > TOLERANCE;
        }
    }
    return other;
}

static void test_the_picture_of_isotherms_is_drawn_by_the_present_code(void **state)
{
    struct iso_image shown = {0}, drawn = {0};
    char command[1024];
    const char *path = scratch_path(*state, "isotherms.png");
    (void)snprintf(command, sizeof command,
                   "%s/sim/gallery/draw.sh isotherms %s/sim/isotherm-sim %s", ISOTHERM_SOURCE_DIR,
                   ISOTHERM_BINARY_DIR, path);
    assert_int_equal(system(command), 0);
    read_picture(ISOTHERM_SOURCE_DIR "/sim/gallery/isotherms.png", &shown);
    read_picture(path, &drawn);
    assert_int_equal(drawn.width_px, shown.width_px);
    assert_int_equal(drawn.height_px, shown.height_px);
    size_t other = count_other_pixels(&shown, &drawn);
    size_t pixels = (size_t)shown.width_px * (size_t)shown.height_px;
    if (other * 200 > pixels) {
        fail_msg("sim/gallery/isotherms.png: %zu of %zu pixels are not what sim/gallery/draw.sh "
                 "draws now",
                 other, pixels);
    }
    iso_image_done(&shown);
    iso_image_done(&drawn);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_architecture_lists_the_stages),
        cmocka_unit_test(test_the_diagram_has_the_stages),
        cmocka_unit_test_setup_teardown(test_the_picture_of_isotherms_is_drawn_by_the_present_code,
                                        scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
