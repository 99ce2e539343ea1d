/* Small scans in the formats of public databases. A failure fails the running test. */
#ifndef TESTS_SIM_CORPUS_SCAN_FILES_H
#define TESTS_SIM_CORPUS_SCAN_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "isotherm/vec.h"

enum { SCAN_ROWS = 50, SCAN_COLUMNS = 40, SCAN_POINTS = SCAN_ROWS * SCAN_COLUMNS };

/* A dome with 1 mm pitch. Its summit, z 30, is at (5, -8), and one corner was not measured. */
struct iso_vec3 scan_dome(int row, int column);
bool scan_dome_measured(int row, int column);

typedef void scan_writer(FILE *out);

/* Writers of the dome: as a range image of FRGC, 1.5 m from the scanner; as a file of Bosphorus;
 * and in VRML, as quads and triangles, where points that are no coordinates come first. */
scan_writer scan_write_abs, scan_write_bnt, scan_write_vrml;

/* Returns the bytes that a writer writes. Free them with free(). */
char *scan_file_bytes(scan_writer *write, size_t *size);

#endif
