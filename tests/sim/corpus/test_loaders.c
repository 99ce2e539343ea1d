/* Readers of the scans of public databases, on small files that the test writes in their formats.
 */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/corpus/scan_file.h"
#include "sim/corpus/scan_view.h"
#include "tests/sim/corpus/scan_files.h"

/* Returns the error of the depth at the pixel of the virtual camera where the point (x, y) of the
 * dome appears. Without a measurement it is minus the depth. */
static double depth_of(const struct iso_frame *frame, struct iso_vec3 shift, double x, double y)
{
    double z = 30.0 - 0.02 * ((x - 5.0) * (x - 5.0) + (y + 8.0) * (y + 8.0));
    struct iso_vec3 p = {x - shift.x, shift.y - y, 600.0 + shift.z - z};
    double u, v;
    assert_true(iso_camera_project(&frame->camera, p, &u, &v));
    return (double)iso_frame_depth_at(frame, (int)lround(u), (int)lround(v)) - p.z;
}

typedef int parser(const char *name, const char *bytes, size_t size, struct iso_mesh **out,
                   struct iso_fault *fault);

static const struct kind {
    const char *name;
    scan_writer *write;
    parser *parse;
    double z_mm; /* the z that the format adds */
} kinds[] = {
    {"f.abs", scan_write_abs, sim_scan_parse_abs, -1500.0},
    {"b.bnt", scan_write_bnt, sim_scan_parse_bnt, 0.0},
    {"v.wrl", scan_write_vrml, sim_scan_parse_vrml, 0.0},
};

static void test_scans_are_seen(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        size_t size;
        char *bytes = scan_file_bytes(kinds[k].write, &size);
        struct iso_mesh *mesh = NULL;
        struct iso_fault fault = {.text = ""};
        if (kinds[k].parse(kinds[k].name, bytes, size, &mesh, &fault)) {
            fail_msg("%s", fault.text);
        }
        assert_in_range(mesh->n_triangles, 3700, 2 * (SCAN_ROWS - 1) * (SCAN_COLUMNS - 1));
        double highest = -1e9;
        for (int32_t i = 0; i < mesh->n_vertices; i++) {
            highest = fmax(highest, mesh->vertices_mm[i].z);
        }
        assert_float_equal(highest, (30.0 + kinds[k].z_mm), 1e-3);
        struct iso_frame *frame = NULL;
        assert_int_equal(sim_scan_view(mesh, &frame), 0);
        assert_int_equal(iso_frame_check(frame, NULL), 0);
        /* A vertex shows the shift: the last vertex is the last point of the grid. */
        struct iso_vec3 last = mesh->vertices_mm[mesh->n_vertices - 1],
                        known = scan_dome(SCAN_ROWS - 1, SCAN_COLUMNS - 1);
        struct iso_vec3 shift = {known.x - last.x, known.y + last.y, known.z + last.z - 600.0};
        for (double x = -12.0; x < 22.0; x += 5.5) {
            for (double y = -28.0; y < 8.0; y += 5.5) {
                assert_float_equal(depth_of(frame, shift, x, y), 0.0, 0.35);
            }
        }
        /* The upper left corner was not measured. */
        assert_true(depth_of(frame, shift, -13.0, 16.0) < -100.0);
        iso_frame_free(frame);
        iso_mesh_free(mesh);
        free(bytes);
    }
}

static void refused(parser *parse, const char *bytes, size_t size, const char *words)
{
    struct iso_mesh *mesh = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(parse("file", bytes, size, &mesh, &fault), -EBADMSG);
    assert_null(mesh);
    if (!strstr(fault.text, words) || !strstr(fault.text, "file: ")) {
        fail_msg("'%s' does not say '%s'", fault.text, words);
    }
}

static void refused_text(parser *parse, const char *text, const char *words)
{
    refused(parse, text, strlen(text), words);
}

static void test_damaged_scans(void **state)
{
    (void)state;
    parser *abs = sim_scan_parse_abs, *bnt = sim_scan_parse_bnt, *vrml = sim_scan_parse_vrml;
    refused_text(abs, "", "rows");
    refused_text(abs, "3 columns", "how many rows");
    refused_text(abs, "3 rows\n2 rows", "how many columns");
    refused_text(abs, "3 rows\n2 columns\n1 1 1", "no pixels");
    refused_text(abs, "3 rows\n9999 columns\npixels (flag X Y Z):\n1", "9999 points");
    refused_text(abs, "2 rows\n2 columns\npixels:\n1 1 1 1 0 1 0 1 0 0 1 1 5 5 5", "in its z");
    refused_text(abs, "2 rows\n2 columns\npixels:\n1 1 1 1 0 nan 0 1", "in its x");
    refused_text(abs, "2 rows\n2 columns\npixels:\n0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0", "no surface");
    refused_text(vrml, "VRML", "not VRML");
    refused_text(vrml, "#VRML V2.0 utf8\nCoordinate { point [ 1 2 3 ] }", "no faces");
    refused_text(vrml, "#VRML V2.0 utf8\nCoordinate { point [ 1 2 ] }", "three coordinates");
    refused_text(vrml, "#VRML V2.0 utf8\nCoordinate { point [ 1 2 x ] }", "no number");
    refused_text(vrml, "#VRML V2.0 utf8\nCoordinate { point [ 1 2 1e9 ] }", "out of range");
    refused_text(vrml, "#VRML V2.0 utf8\nCoordinate { point 1 2 3 }", "begin with [");
    refused_text(vrml, "#VRML V2.0 utf8\nCoordinate { point [ 1 2 3", "list ends");
    refused_text(vrml, "#VRML V2.0 utf8\ncoordIndex [ 0 1 2 ]", "not among the points");
    refused_text(vrml,
                 "#VRML V2.0 utf8\nCoordinate { point [ 0 0 0 1 0 0 0 1 0 ] } coordIndex [ 0 1 3 ]",
                 "not among the points");
    size_t size;
    char *bytes = scan_file_bytes(scan_write_bnt, &size);
    refused(bnt, bytes, 13, "truncated");
    refused(bnt, bytes, size - 1, "does not hold");
    bytes[0] = 1; /* one row */
    refused(bnt, bytes, size, "1 rows");
    free(bytes);
}

/* In VRML 1.0 the name is Coordinate3. Each of two face sets numbers its points from 0. */
static void test_vrml_nodes(void **state)
{
    (void)state;
    static const char text[] = "#VRML V1.0 ascii\nSeparator {\n"
                               "Coordinate3 { point [0 0 0, 1 0 0, 0 1 0] }\n"
                               "IndexedFaceSet { coordIndex [0,1,2,-1] }\n"
                               "Coordinate3 { point [0 0 5, 1 0 5, 0 1 5, 1 1 5] }\n"
                               "IndexedFaceSet { coordIndex [0,1,3,2,-1, 1,1,2] } }";
    struct iso_mesh *mesh = NULL;
    assert_int_equal(sim_scan_parse_vrml("two", text, sizeof text - 1, &mesh, NULL), 0);
    assert_int_equal(mesh->n_vertices, 7);
    assert_int_equal(mesh->n_triangles, 3); /* the last face has only two corners */
    assert_int_equal(mesh->triangles[2][0], 3);
    assert_int_equal(mesh->triangles[2][1], 6);
    assert_int_equal(mesh->triangles[2][2], 5);
    iso_mesh_free(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scans_are_seen),
        cmocka_unit_test(test_damaged_scans),
        cmocka_unit_test(test_vrml_nodes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
