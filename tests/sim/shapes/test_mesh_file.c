/* Mesh files of every format, valid and damaged. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/base/bytes.h"
#include "sim/shapes/mesh/mesh_file.h"
#include "tests/support/near.h"
#include "tests/support/scratch.h"

/* A tetrahedron whose corners all differ in every coordinate. */
static const double corners[4][3] = {{1, 2, 3}, {5, 2.5, 3.25}, {1.5, 7, 3.5}, {2, 3, 9}};
static const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

static int parse(enum iso_mesh_format format, const void *bytes, size_t size, const char *tri,
                 struct iso_coloured_mesh *out, struct iso_fault *fault)
{
    char *copy = malloc(size + 1), *tri_copy = tri ? strdup(tri) : NULL;
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    copy[size] = '\0';
    int error = iso_mesh_parse(format, "m", copy, size, tri_copy, out, fault);
    free(copy);
    free(tri_copy);
    return error;
}

static struct iso_coloured_mesh parsed(enum iso_mesh_format format, const void *bytes, size_t size,
                                       const char *tri)
{
    struct iso_coloured_mesh mesh = {NULL, NULL};
    struct iso_fault fault = {.text = ""};
    if (parse(format, bytes, size, tri, &mesh, &fault)) {
        fail_msg("%s", fault.text);
    }
    return mesh;
}

static struct iso_coloured_mesh parsed_text(enum iso_mesh_format format, const char *text)
{
    return parsed(format, text, strlen(text), NULL);
}

static void assert_tetrahedron(struct iso_coloured_mesh *mesh)
{
    assert_int_equal(mesh->mesh->n_vertices, 4);
    assert_int_equal(mesh->mesh->n_triangles, 4);
    for (int v = 0; v < 4; v++) {
        assert_near(mesh->mesh->vertices_mm[v].x, corners[v][0], 1e-6);
        assert_near(mesh->mesh->vertices_mm[v].y, corners[v][1], 1e-6);
        assert_near(mesh->mesh->vertices_mm[v].z, corners[v][2], 1e-6);
    }
    for (int t = 0; t < 4; t++) {
        for (int k = 0; k < 3; k++) {
            assert_int_equal(mesh->mesh->triangles[t][k], faces[t][k]);
        }
    }
    iso_coloured_mesh_done(mesh);
}

static void reads_off(void **state)
{
    (void)state;
    struct iso_coloured_mesh mesh = parsed_text(
        ISO_MESH_FORMAT_OFF, "OFF # a comment\n4 4 6\n1 2 3\n5 2.5 3.25\r\n\n1.5 7 35e-1\n2 3 9\n"
                             "3 0 2 1\n3  0 1 3 255 0 0\n# another\n3 1 2 3\n3 0 3 2\n");
    assert_null(mesh.colour);
    assert_tetrahedron(&mesh);
    mesh = parsed_text(ISO_MESH_FORMAT_OFF, "OFF 4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"
                                            "3 0 1 2\n");
    assert_int_equal(mesh.mesh->n_triangles, 3); /* the square becomes a fan of two */
    assert_int_equal(mesh.mesh->triangles[1][0], 0);
    assert_int_equal(mesh.mesh->triangles[1][1], 2);
    assert_int_equal(mesh.mesh->triangles[1][2], 3);
    iso_coloured_mesh_done(&mesh);
}

static void reads_colours(void **state)
{
    (void)state;
    struct iso_coloured_mesh mesh = parsed_text(ISO_MESH_FORMAT_OFF,
                                                "COFF\n3 1 0\n0 0 0 255 51 0 255\n1 0 0 0 0 102\n"
                                                "0 1 0 0.5 0.25 1.\n3 0 1 2\n");
    assert_near(mesh.colour[0].channel[1], 0.2, 1e-6);
    assert_near(mesh.colour[1].channel[2], 0.4, 1e-6);
    assert_near(mesh.colour[2].channel[1], 0.25, 1e-6);
    iso_coloured_mesh_done(&mesh);
    mesh = parsed_text(ISO_MESH_FORMAT_OBJ,
                       "v 0 0 0 255 51 0\nv 1 0 0 0 0 102\nv 0 1 0 0.5 0.25 1.\nf 1 2 3\n");
    assert_near(mesh.colour[0].channel[0], 1.0, 1e-6);
    assert_near(mesh.colour[2].channel[2], 1.0, 1e-6);
    iso_coloured_mesh_done(&mesh);
}

static void reads_obj(void **state)
{
    (void)state;
    struct iso_coloured_mesh mesh = parsed_text(
        ISO_MESH_FORMAT_OBJ, "# made by hand\nmtllib x.mtl\no thing\nv 1 2 3\n"
                             "v 5 2.5 3.25 1.0\nvt 0 0\nvn 0 0 1\nv 1.5 7 3.5\nv 2 3 9\n"
                             "s off\nf 1 3 2\nf 1/1 2/1 4/1\nf 2//1 3//1 4//1\n"
                             "f -4/1/1 -1/1/1 -2/1/1\n");
    assert_tetrahedron(&mesh);
}

static void reads_tosca(void **state)
{
    (void)state;
    const char *vert = "1 2 3\n5 2.5 3.25\n1.5\t7 3.5\n  2 3 9\n\n";
    struct iso_coloured_mesh mesh = parsed(ISO_MESH_FORMAT_TOSCA, vert, strlen(vert),
                                           "1 3 2\n1 2 4\n2 3 4\n1 4 3\n");
    assert_tetrahedron(&mesh);
}

static void reads_ply_text(void **state)
{
    (void)state;
    struct iso_coloured_mesh mesh = parsed_text(
        ISO_MESH_FORMAT_PLY,
        "ply\nformat ascii 1.0\ncomment nothing\nelement vertex 4\nproperty double z\n"
        "property float32 x\nproperty float y\nproperty uchar quality\nelement edge 1\n"
        "property int a\nproperty int b\nelement face 4\nproperty list uchar int vertex_index\n"
        "property float flag\nend_header\n3 1 2 7\n3.25 5 2.5 7\n3.5 1.5 7 7\n9 2 3 7\n0 1\n"
        "3 0 2 1 0\n3 0 1 3 1\n3 1 2 3 2\n3 0 3 2 3\n");
    assert_tetrahedron(&mesh);
}

/* Appends the bytes of a number, lowest first or last. */
static uint8_t *put(uint8_t *at, const void *value, size_t n, int big)
{
    const uint8_t *bytes = value; /* of a little-endian machine, like those of CI */
    for (size_t i = 0; i < n; i++) {
        at[i] = bytes[big ? n - 1 - i : i];
    }
    return at + n;
}

static void reads_ply_binary(void **state)
{
    (void)state;
    for (int big = 0; big < 2; big++) {
        char bytes[1024];
        int head = snprintf(bytes, sizeof bytes,
                            "ply\nformat binary_%s_endian 1.0\nelement vertex 4\n"
                            "property float x\nproperty double y\nproperty float z\n"
                            "property uchar red\nproperty uchar green\nproperty ushort blue\n"
                            "element face 4\nproperty list uchar uint vertex_indices\nend_header\n",
                            big ? "big" : "little");
        uint8_t *at = (uint8_t *)bytes + head;
        for (int v = 0; v < 4; v++) {
            float x = (float)corners[v][0], z = (float)corners[v][2];
            uint8_t red = 255, green = (uint8_t)(51 * v);
            uint16_t blue = 13107;
            at = put(put(put(at, &x, 4, big), &corners[v][1], 8, big), &z, 4, big);
            at = put(put(put(at, &red, 1, big), &green, 1, big), &blue, 2, big);
        }
        for (int t = 0; t < 4; t++) {
            uint8_t three = 3;
            at = put(at, &three, 1, big);
            for (int k = 0; k < 3; k++) {
                uint32_t corner = (uint32_t)faces[t][k];
                at = put(at, &corner, 4, big);
            }
        }
        size_t size = (size_t)(at - (uint8_t *)bytes);
        struct iso_coloured_mesh mesh = parsed(ISO_MESH_FORMAT_PLY, bytes, size, NULL);
        assert_near(mesh.colour[0].channel[0], 1.0, 1e-6);
        assert_near(mesh.colour[2].channel[1], 0.4, 1e-6);
        assert_near(mesh.colour[3].channel[2], 0.2, 1e-6);
        assert_tetrahedron(&mesh);
        for (size_t cut = 1; cut < 120; cut += 7) { /* no byte after the end is read */
            struct iso_coloured_mesh none = {NULL, NULL};
            assert_int_equal(parse(ISO_MESH_FORMAT_PLY, bytes, size - cut, NULL, &none, NULL),
                             -EBADMSG);
        }
    }
}

static void reads_stl(void **state)
{
    (void)state;
    uint8_t bytes[84 + 4 * 50] = "solid, although binary";
    uint8_t *at = iso_put_u32(bytes + 80, 4);
    for (int t = 0; t < 4; t++) {
        for (int k = -1; k < 3; k++) {
            for (int c = 0; c < 3; c++) {
                at = iso_put_f32(at, k < 0 ? 0.0f : (float)corners[faces[t][k]][c]);
            }
        }
        at = iso_put_u16(at, 0);
    }
    struct iso_coloured_mesh mesh = parsed(ISO_MESH_FORMAT_STL, bytes, sizeof bytes, NULL);
    struct iso_mesh_mended mended;
    assert_int_equal(mesh.mesh->n_vertices, 12);
    assert_int_equal(iso_mesh_mend(&mesh, &mended), 0);
    assert_int_equal(mesh.mesh->n_vertices, 4);
    assert_int_equal(mended.merged, 8);
    assert_near(iso_mesh_area(mesh.mesh), 54.13683, 1e-4);
    iso_coloured_mesh_done(&mesh);
    mesh = parsed_text(ISO_MESH_FORMAT_STL,
                       "solid a b c\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n"
                       "   vertex 1 0 0\n   vertex 0 1 0\n  endloop\n endfacet\nendsolid a\n");
    assert_near(iso_mesh_area(mesh.mesh), 0.5, 1e-12);
    iso_coloured_mesh_done(&mesh);
}

/* Files that every reader refuses, and the text of the refusal. */
static const struct {
    enum iso_mesh_format format;
    const char *text, *tri, *words;
} damaged[] = {
    {ISO_MESH_FORMAT_OFF, "OF\n", NULL, "m:1: does not begin with OFF"},
    {ISO_MESH_FORMAT_OFF, "OFF\n3 x 0\n", NULL, "m:2: bad counts"},
    {ISO_MESH_FORMAT_OFF, "OFF\n3 1 0\n0 0 0\n", NULL, "ends within the vertices"},
    {ISO_MESH_FORMAT_OFF, "OFF\n1 1 0\n0 nan 0\n", NULL, "m:3: bad coordinate 'nan'"},
    {ISO_MESH_FORMAT_OFF, "OFF\n1 1 0\n0 0\n", NULL, "m:3: 2 numbers of a vertex"},
    {ISO_MESH_FORMAT_OFF, "OFF\n1 1 0\n0 0 0\n3 0 0\n", NULL, "m:4: 2 corners instead of 3"},
    {ISO_MESH_FORMAT_OFF, "OFF\n1 1 0\n0 0 0\n2 0 0\n", NULL, "bad number of corners '2'"},
    {ISO_MESH_FORMAT_OFF, "OFF\n1 1 0\n0 0 0\n3 0 0 1\n", NULL, "none of the 1 vertices"},
    {ISO_MESH_FORMAT_OFF, "OFF\n1 0 0\n0 0 0\n", NULL, "m: no triangles"},
    {ISO_MESH_FORMAT_OFF, "OFF\n1 1 0\n0 0 0\n3 0 0 0\n9\n", NULL, "more than was announced"},
    {ISO_MESH_FORMAT_OFF, "COFF\n1 1 0\n0 0 0 256 0 0\n", NULL, "bad colour '256'"},
    {ISO_MESH_FORMAT_OBJ, "v 0 0 0\nf 1 1\n", NULL, "m:2: a face of 2 corners"},
    {ISO_MESH_FORMAT_OBJ, "v 0 0 0\nf 0 1 1\n", NULL, "m:2: bad corner '0'"},
    {ISO_MESH_FORMAT_OBJ, "v 0 0 0\nf -2 1 1\n", NULL, "m:2: bad corner '-2'"},
    {ISO_MESH_FORMAT_OBJ, "vertex 0 0 0\n", NULL, "m:1: unknown statement 'vertex'"},
    {ISO_MESH_FORMAT_OBJ, "v 0 0 0 1 1 1\nv 1 0 0\n", NULL, "m:2: some vertices have a colour"},
    {ISO_MESH_FORMAT_TOSCA, "0 0 0\n1 0\n", "1 1 1\n", "m:2: 2 numbers instead of 3"},
    {ISO_MESH_FORMAT_TOSCA, "0 0 0\n", "0 1 1\n", "m:1: bad corner (they count from 1) '0'"},
    {ISO_MESH_FORMAT_TOSCA, "0 0 0\n", "1 1 2\n", "none of the 1 vertices"},
    {ISO_MESH_FORMAT_STL, "solid\nvertex 0 0 0\nendfacet\n", NULL, "a facet that is no triangle"},
    {ISO_MESH_FORMAT_STL, "solid\nvertex 0 0 0\n", NULL, "ends within a triangle"},
    {ISO_MESH_FORMAT_STL, "solid\nfacets\n", NULL, "not a line of an STL file: 'facets'"},
    {ISO_MESH_FORMAT_STL, "sol", NULL, "neither text nor"},
    {ISO_MESH_FORMAT_PLY, "plyy\n", NULL, "does not begin with ply"},
    {ISO_MESH_FORMAT_PLY, "ply\nformat ascii 1.0\n", NULL, "no end_header"},
    {ISO_MESH_FORMAT_PLY, "ply\nformat morse 1.0\n", NULL, "m:2: unknown format 'morse'"},
    {ISO_MESH_FORMAT_PLY, "ply\nelement face 1\nend_header\n", NULL, "no format before"},
    {ISO_MESH_FORMAT_PLY, "ply\nproperty int x\n", NULL, "a property too many: 'x'"},
    {ISO_MESH_FORMAT_PLY, "ply\nelement face 1\nproperty real x\n", NULL, "bad type of property"},
    {ISO_MESH_FORMAT_PLY, "ply\nelement vertex 1\nproperty int x\nproperty int x\n", NULL,
     "a second property 'x'"},
    {ISO_MESH_FORMAT_PLY, "ply\nformat ascii 1.0\nelement vertex 1\nend_header\n", NULL,
     "not one element each"},
};

static void refuses_damage(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof damaged / sizeof *damaged; i++) {
        struct iso_coloured_mesh mesh = {NULL, NULL};
        struct iso_fault fault = {.text = ""};
        int error = parse(damaged[i].format, damaged[i].text, strlen(damaged[i].text),
                          damaged[i].tri, &mesh, &fault);
        if (error != -EBADMSG || !strstr(fault.text, damaged[i].words)) {
            fail_msg("%s: %d, '%s' without '%s'", damaged[i].text, error, fault.text,
                     damaged[i].words);
        }
        assert_null(mesh.mesh);
    }
}

static void mends(void **state)
{
    (void)state;
    /* Two triangles of a square with separate vertices. One triangle is there twice, the second
     * time in the other direction; one triangle has no area; one vertex belongs to no triangle; the
     * colours differ along the seam. */
    struct iso_coloured_mesh mesh = parsed_text(
        ISO_MESH_FORMAT_OFF,
        "COFF\n7 4 0\n0 0 0 0 0 0\n9 9 9 0 0 0\n1 0 0 100 0 0\n1 1 0 0 0 0\n1 0 0 200 0 0\n"
        "1 1 0 0 0 0\n0 1 0 0 0 0\n3 0 2 3\n3 3 5 0\n3 0 5 6\n3 5 4 0\n");
    struct iso_mesh_mended mended;
    assert_int_equal(iso_mesh_mend(&mesh, &mended), 0);
    assert_int_equal(mended.merged, 2);
    assert_int_equal(mended.collapsed, 1);
    assert_int_equal(mended.repeated, 1);
    assert_int_equal(mended.unused, 1);
    assert_int_equal(mesh.mesh->n_vertices, 4);
    assert_int_equal(mesh.mesh->n_triangles, 2);
    assert_near(iso_mesh_area(mesh.mesh), 1.0, 1e-12);
    assert_near(mesh.colour[1].channel[0], 150.0 / 255.0, 1e-6);
    assert_int_equal(iso_mesh_check(mesh.mesh, NULL), 0);
    iso_coloured_mesh_done(&mesh);

    mesh = parsed_text(ISO_MESH_FORMAT_OFF, "OFF\n2 1 0\n0 0 0\n0 0 0\n3 0 1 0\n");
    assert_int_equal(iso_mesh_mend(&mesh, &mended), -EBADMSG);
    assert_int_equal(mesh.mesh->n_vertices, 2);
    iso_coloured_mesh_done(&mesh);
}

static void reads_files(void **state)
{
    struct iso_coloured_mesh mesh = {NULL, NULL};
    struct iso_fault fault = {.text = ""};
    scratch_write_text(scratch_path(*state, "a.vert"), "1 2 3\n5 2.5 3.25\n1.5 7 3.5\n2 3 9\n");
    assert_int_equal(iso_mesh_file_read(scratch_path(*state, "a.vert"), &mesh, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "a.tri"));
    scratch_write_text(scratch_path(*state, "a.tri"), "1 3 2\n1 2 4\n2 3 4\n1 4 3\n");
    assert_int_equal(iso_mesh_file_read(scratch_path(*state, "a.vert"), &mesh, &fault), 0);
    assert_tetrahedron(&mesh);
    scratch_write_text(scratch_path(*state, "b.OFF"), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    assert_int_equal(iso_mesh_file_read(scratch_path(*state, "b.OFF"), &mesh, &fault), 0);
    iso_coloured_mesh_done(&mesh);
    assert_int_equal(iso_mesh_file_read(scratch_path(*state, "c.ply"), &mesh, &fault), -ENOENT);
    assert_int_equal(iso_mesh_file_read(scratch_path(*state, "d.xyz"), &mesh, &fault), -ENOTSUP);
    scratch_write(scratch_path(*state, "e.obj"), "v 0\0", 4);
    assert_int_equal(iso_mesh_file_read(scratch_path(*state, "e.obj"), &mesh, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "NUL"));
    scratch_write_text(scratch_path(*state, "f.obj"), "v 0 0 0\nf 1 1 1\n");
    assert_int_equal(iso_mesh_file_read(scratch_path(*state, "f.obj"), &mesh, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "no triangle is left"));
    assert_null(mesh.mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_off),
        cmocka_unit_test(reads_colours),
        cmocka_unit_test(reads_obj),
        cmocka_unit_test(reads_tosca),
        cmocka_unit_test(reads_ply_text),
        cmocka_unit_test(reads_ply_binary),
        cmocka_unit_test(reads_stl),
        cmocka_unit_test(refuses_damage),
        cmocka_unit_test(mends),
        cmocka_unit_test_setup_teardown(reads_files, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
