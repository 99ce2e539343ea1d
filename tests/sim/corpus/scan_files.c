#include "tests/sim/corpus/scan_files.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

struct iso_vec3 scan_dome(int row, int column)
{
    double x = column - SCAN_COLUMNS / 2 + 5.0, y = SCAN_ROWS / 2 - row - 8.0;
    return iso_vec3(x, y, 30.0 - 0.02 * ((x - 5.0) * (x - 5.0) + (y + 8.0) * (y + 8.0)));
}

bool scan_dome_measured(int row, int column)
{
    return row > 5 || column > 7;
}

char *scan_file_bytes(scan_writer *write, size_t *size)
{
    char *text = NULL;
    FILE *out = open_memstream(&text, size);
    assert_non_null(out);
    write(out);
    assert_int_equal(fclose(out), 0);
    return text;
}

void scan_write_abs(FILE *out)
{
    fprintf(out, "%d rows\n%d columns\npixels (flag X Y Z):\n", SCAN_ROWS, SCAN_COLUMNS);
    for (int plane = 0; plane < 4; plane++) {
        for (int i = 0; i < SCAN_POINTS; i++) {
            struct iso_vec3 p = scan_dome(i / SCAN_COLUMNS, i % SCAN_COLUMNS);
            bool good = scan_dome_measured(i / SCAN_COLUMNS, i % SCAN_COLUMNS);
            if (plane == 0) {
                fprintf(out, "%d ", good);
            } else {
                /* 1.5 m from the scanner */
                const double value[] = {p.x, p.y, p.z - 1500.0};
                fprintf(out, "%.6f ", good ? value[plane - 1] : -999999.0);
            }
        }
        fputc('\n', out);
    }
}

static void put(FILE *out, const void *value, size_t size)
{
    assert_int_equal(fwrite(value, 1, size, out), size); /* little endian, like all our machines */
}

void scan_write_bnt(FILE *out)
{
    const uint16_t rows = SCAN_ROWS, columns = SCAN_COLUMNS, length = 9;
    const uint32_t n = 5 * SCAN_POINTS;
    const double zmin = -1000000000.0;
    put(out, &rows, 2);
    put(out, &columns, 2);
    put(out, &zmin, 8);
    put(out, &length, 2);
    put(out, "bs000.png", 9);
    put(out, &n, 4);
    for (int plane = 0; plane < 5; plane++) {
        for (int i = 0; i < SCAN_POINTS; i++) {
            struct iso_vec3 p = scan_dome(i / SCAN_COLUMNS, i % SCAN_COLUMNS);
            const double values[5] = {p.x, p.y, p.z, 0.5, 0.5};
            const bool good = scan_dome_measured(i / SCAN_COLUMNS, i % SCAN_COLUMNS);
            put(out, good ? &values[plane] : &zmin, 8);
        }
    }
}

void scan_write_vrml(FILE *out)
{
    fputs("#VRML V2.0 utf8\n# a comment with point [ 1 2 3 ] and { in it\n"
          "Shape { appearance Appearance { texture ImageTexture { url \"a } b.bmp\" } }\n"
          "geometry IndexedFaceSet {\n texCoord TextureCoordinate { point [ 0 0, 1 1 ] }\n"
          " coord Coordinate { point [\n",
          out);
    for (int i = 0; i < SCAN_POINTS; i++) {
        struct iso_vec3 p = scan_dome(i / SCAN_COLUMNS, i % SCAN_COLUMNS);
        fprintf(out, "%.4f %.4f %.4f,\n", p.x, p.y, p.z);
    }
    fputs("] }\n coordIndex [\n", out);
    for (int row = 0; row + 1 < SCAN_ROWS; row++) {
        for (int column = 0; column + 1 < SCAN_COLUMNS; column++) {
            int a = row * SCAN_COLUMNS + column, b = a + SCAN_COLUMNS;
            if (scan_dome_measured(row, column) && row % 2 == 0) {
                fprintf(out, "%d, %d, %d, %d, -1,\n", a, b, b + 1, a + 1);
            } else if (scan_dome_measured(row, column)) {
                fprintf(out, "%d %d %d -1 %d %d %d -1\n", a, b, b + 1, a, b + 1, a + 1);
            }
        }
    }
    fputs("]\n texCoordIndex [ 0, 1, 0, -1 ]\n} }\n", out);
}
