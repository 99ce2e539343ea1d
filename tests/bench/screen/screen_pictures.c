/* Draws pictures of isotherm-screen with a head that moves, for a script that counts instructions
 * from outside (instructions.sh).
 *
 *   screen_pictures WIDTH HEIGHT PICTURES */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "enroll/screen/draw/picture.h"
#include "enroll/screen/language/language.h"
#include "enroll/screen/painter.h"

/* A head of the size that one at arm's length has, and shoulders. */
static void move_head(struct iso_outline_record *record, int picture)
{
    const double x = 40.0 + 8.0 * sin(0.2 * picture);
    const double y = 28.0 + 3.0 * cos(0.3 * picture);
    *record = (struct iso_outline_record){
        .distance_mm = 600, .n_points = ISO_OUTLINE_POINTS, .hint = "ok"};
    for (int i = 0; i < ISO_OUTLINE_POINTS; i++) {
        const double angle = 2.0 * M_PI * i / ISO_OUTLINE_POINTS;
        record->outline[i][0] = (int16_t)(ISO_OUTLINE_UNITS * (x + 9.0 * cos(angle)));
        record->outline[i][1] = (int16_t)(ISO_OUTLINE_UNITS * (y + 13.0 * sin(angle)));
    }
    for (int row = 0; row < ISO_SILHOUETTE_ROWS; row++) {
        for (int column = 0; column < ISO_SILHOUETTE_COLUMNS; column++) {
            const double u = (column - x) / 9.0;
            const double v = (row - y) / 13.0;
            if (u * u + v * v < 1.0 || row > y + 16.0 + 0.1 * fabs(column - x)) {
                record->silhouette[row][column / 8] |= (uint8_t)(0x80 >> column % 8);
            }
        }
    }
}

int main(int argc, char **argv)
{
    if (argc != 4) {
        fprintf(stderr, "usage: %s WIDTH HEIGHT PICTURES\n", argv[0]);
        return 2;
    }
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, atoi(argv[1]),
                                                          atoi(argv[2]));
    const struct screen_look look = {
        .place = "Isotherm", .clock = "", .date = "", .fingerprint = ""};
    struct screen_scene_memory memory = {.hint = NULL};
    struct screen_state state = {
        .connected = true, .sees = true, .mode = "watch", .has_record = true};
    if (screen_language_set("en", "")) {
        return 1;
    }
    for (int i = 0; i < atoi(argv[3]); i++) {
        move_head(&state.record, i);
        const struct screen_scene scene = screen_scene_of(&memory, &state, 1);
        if (scene.kind != SCREEN_NEAR) {
            fprintf(stderr, "the scene is not that of a person before the camera\n");
            return 1;
        }
        screen_paint_surface(surface, 0, &scene, &look);
    }
    cairo_surface_destroy(surface);
    return 0;
}
