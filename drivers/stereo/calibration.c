#include "drivers/stereo/calibration.h"

#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/ini_table.h"
#include "drivers/file/text.h"

enum { FILE_MAX_BYTES = 65536 };

/* The contents of a file. */
struct parse {
    struct iso_stereo_calibration calibration;
    struct iso_vec3 turn_rad;
    int format;
};

/* Marks of the keys. An optional key is left out if it was not measured or does not apply. */
enum { REQUIRED, OPTIONAL };

#define IN(field) offsetof(struct parse, field)
#define CAMERA_KEYS(section, eye)                                                              \
    {section, "width_px", iso_ini_parse_int, IN(calibration.camera[eye].width_px), REQUIRED},  \
        {section, "height_px", iso_ini_parse_int, IN(calibration.camera[eye].height_px),       \
         REQUIRED},                                                                            \
        {section, "fx_px", iso_ini_parse_number, IN(calibration.camera[eye].fx_px), REQUIRED}, \
        {section, "fy_px", iso_ini_parse_number, IN(calibration.camera[eye].fy_px), REQUIRED}, \
        {section, "cx_px", iso_ini_parse_number, IN(calibration.camera[eye].cx_px), REQUIRED}, \
        {section, "cy_px", iso_ini_parse_number, IN(calibration.camera[eye].cy_px), REQUIRED}, \
        {section, "k1", iso_ini_parse_number, IN(calibration.camera[eye].k1), OPTIONAL},       \
        {section, "k2", iso_ini_parse_number, IN(calibration.camera[eye].k2), OPTIONAL},       \
        {section, "k3", iso_ini_parse_number, IN(calibration.camera[eye].k3), OPTIONAL},       \
        {section, "p1", iso_ini_parse_number, IN(calibration.camera[eye].p1), OPTIONAL},       \
    {                                                                                          \
        section, "p2", iso_ini_parse_number, IN(calibration.camera[eye].p2), OPTIONAL          \
    }

static const char extrinsics[] = "right_from_left";

static const struct iso_ini_key keys[] = {
    {"stereo", "format", iso_ini_parse_int, IN(format), REQUIRED},
    {"stereo", "pairs", iso_ini_parse_int, IN(calibration.pairs), OPTIONAL},
    {"stereo", "rms_px", iso_ini_parse_number, IN(calibration.rms_px), OPTIONAL},
    CAMERA_KEYS("left", ISO_EYE_LEFT),
    CAMERA_KEYS("right", ISO_EYE_RIGHT),
    {extrinsics, "rx_rad", iso_ini_parse_number, IN(turn_rad.x), REQUIRED},
    {extrinsics, "ry_rad", iso_ini_parse_number, IN(turn_rad.y), REQUIRED},
    {extrinsics, "rz_rad", iso_ini_parse_number, IN(turn_rad.z), REQUIRED},
    {extrinsics, "tx_mm", iso_ini_parse_number, IN(calibration.right_from_left.translation_mm.x),
     REQUIRED},
    {extrinsics, "ty_mm", iso_ini_parse_number, IN(calibration.right_from_left.translation_mm.y),
     REQUIRED},
    {extrinsics, "tz_mm", iso_ini_parse_number, IN(calibration.right_from_left.translation_mm.z),
     REQUIRED},
};

enum { KEYS = sizeof keys / sizeof *keys };
_Static_assert((int)KEYS <= (int)ISO_INI_KEYS_MAX, "bits of what was seen");

/* ---- what can be a pair ---- */

double iso_stereo_baseline_mm(const struct iso_stereo_calibration *calibration)
{
    return iso_norm(calibration->right_from_left.translation_mm);
}

static bool is_rotation(const struct iso_mat3 *a)
{
    struct iso_mat3 transposed = iso_mat3_transpose(a);
    struct iso_mat3 product = iso_mat3_mul(a, &transposed);
    double off = 0.0;
    for (int i = 0; i < 9; i++) {
        off += fabs(product.m[i / 3][i % 3] - (i % 4 == 0));
    }
    const struct iso_vec3 x = iso_vec3(a->m[0][0], a->m[0][1], a->m[0][2]);
    const struct iso_vec3 y = iso_vec3(a->m[1][0], a->m[1][1], a->m[1][2]);
    const struct iso_vec3 z = iso_vec3(a->m[2][0], a->m[2][1], a->m[2][2]);
    return off < 1e-6 && iso_dot(iso_cross(x, y), z) > 0.0; /* also false for NaN */
}

/* Returns NULL, or what is wrong with the position of the right camera. */
static const char *find_bad_stand(const struct iso_stereo_calibration *c)
{
    static const double sine_max = 0.29552020666133955; /* sine of 0.3 rad */
    const double baseline_mm = iso_stereo_baseline_mm(c);
    if (!is_rotation(&c->right_from_left.rotation)) {
        return "the rotation is none";
    }
    if (!(baseline_mm >= 5.0 && baseline_mm <= 1000.0)) {
        return "the baseline must be 5..1000 mm";
    }
    /* The position of the right camera in the left camera's frame. */
    struct iso_rigid left_from_right = iso_rigid_inverse(&c->right_from_left);
    const struct iso_vec3 along = iso_unit(left_from_right.translation_mm);
    const struct iso_vec3 axis = iso_mat3_apply(&left_from_right.rotation, iso_vec3(0.0, 0.0, 1.0));
    if (!(along.x > 0.0)) {
        return "the right camera stands at the left";
    }
    if (fabs(along.z) > sine_max || fabs(iso_dot(along, axis)) > sine_max) {
        return "an optical axis is more than 0.3 rad off the perpendicular to the baseline";
    }
    return NULL;
}

/* Returns what is wrong with a pair of sane cameras, or NULL. */
static const char *find_bad_pair(const struct iso_stereo_calibration *c)
{
    const struct iso_camera *left = &c->camera[ISO_EYE_LEFT], *right = &c->camera[ISO_EYE_RIGHT];
    if (left->projection != ISO_PINHOLE || right->projection != ISO_PINHOLE) {
        return "both cameras must be pinhole cameras";
    }
    if (left->width_px != right->width_px || left->height_px != right->height_px) {
        return "the two images differ in size";
    }
    if (fabs(left->fx_px - right->fx_px) > 0.1 * left->fx_px) {
        return "the focal lengths differ by more than 10 %";
    }
    return find_bad_stand(c);
}

int iso_stereo_calibration_check(const struct iso_stereo_calibration *calibration,
                                 struct iso_fault *fault)
{
    int error = 0;
    for (int eye = 0; eye < ISO_EYES && !error; eye++) {
        error = iso_camera_check(&calibration->camera[eye], fault);
    }
    if (error) {
        return error;
    }
    const char *flaw = find_bad_pair(calibration);
    return flaw ? iso_fault_set(fault, -EINVAL, "%s", flaw) : 0;
}

/* ---- reading ---- */

/* Checks that every key is there, and that the values are consistent. */
static int check_calibration(const char *name, uint64_t seen, struct parse *parse,
                             struct iso_fault *fault)
{
    struct iso_stereo_calibration *c = &parse->calibration;
    struct iso_fault why;
    for (int i = 0; i < KEYS; i++) {
        if (keys[i].mark != OPTIONAL && !(seen & UINT64_C(1) << i)) {
            return iso_fault_set_code(fault, ISO_FAULT_CALIBRATION_WRONG, -EBADMSG,
                                      "%s: %s is missing from [%s]", name, keys[i].name,
                                      keys[i].section);
        }
    }
    if (parse->format != 1) {
        return iso_fault_set_code(fault, ISO_FAULT_CALIBRATION_WRONG, -EBADMSG,
                                  "%s: format %d is not supported", name, parse->format);
    }
    c->camera[ISO_EYE_LEFT].projection = c->camera[ISO_EYE_RIGHT].projection = ISO_PINHOLE;
    c->right_from_left.rotation = iso_mat3_rotation(parse->turn_rad);
    if (iso_stereo_calibration_check(c, &why)) {
        return iso_fault_set_code(fault, ISO_FAULT_CALIBRATION_WRONG, -EBADMSG, "%s: %s", name,
                                  why.text);
    }
    return 0;
}

int iso_stereo_calibration_parse(const char *name, const char *text,
                                 struct iso_stereo_calibration *out, struct iso_fault *fault)
{
    struct parse parse = {.format = 0};
    uint64_t seen = 0;
    int error = iso_ini_read(name, text, keys, KEYS, &parse, &seen, fault);
    if (!error) {
        error = check_calibration(name, seen, &parse, fault);
    }
    if (!error) {
        *out = parse.calibration;
    }
    return error;
}

int iso_stereo_calibration_read(const char *path, struct iso_stereo_calibration *out,
                                struct iso_fault *fault)
{
    char *text = NULL;
    int error = iso_text_read(path, FILE_MAX_BYTES, &text, fault);
    if (!error) {
        error = iso_stereo_calibration_parse(path, text, out, fault);
    }
    free(text);
    return error;
}

/* ---- writing ---- */

/* The rotation vector of a rotation of less than half a turn (the inverse of Rodrigues 1840). */
static struct iso_vec3 turn_of(const struct iso_mat3 *a)
{
    const struct iso_vec3 twice_sine = {a->m[2][1] - a->m[1][2], a->m[0][2] - a->m[2][0],
                                        a->m[1][0] - a->m[0][1]};
    const double sine = 0.5 * iso_norm(twice_sine);
    const double cosine = 0.5 * (a->m[0][0] + a->m[1][1] + a->m[2][2] - 1.0);
    const double angle = atan2(sine, cosine);
    return iso_scale(sine > 1e-12 ? angle / (2.0 * sine) : 0.5, twice_sine);
}

static void print_calibration(FILE *file, const struct iso_stereo_calibration *calibration)
{
    struct parse out = {.calibration = *calibration,
                        .turn_rad = turn_of(&calibration->right_from_left.rotation),
                        .format = 1};
    const char *section = "";
    for (int i = 0; i < KEYS; i++) {
        const char *field = (const char *)&out + keys[i].offset;
        if (strcmp(section, keys[i].section) != 0) {
            (void)fprintf(file, "%s[%s]\n", *section ? "\n" : "", keys[i].section);
            section = keys[i].section;
        }
        if (keys[i].parse == iso_ini_parse_number) {
            iso_text_print_number(file, keys[i].name, *(const double *)(const void *)field);
        } else {
            (void)fprintf(file, "%s = %d\n", keys[i].name, *(const int *)(const void *)field);
        }
    }
}

/* Removes only a regular file, not a device. */
static void remove_partial_file(const char *path)
{
    struct stat status;
    if (lstat(path, &status) == 0 && S_ISREG(status.st_mode)) {
        (void)unlink(path);
    }
}

int iso_stereo_calibration_write(const char *path, const struct iso_stereo_calibration *calibration,
                                 struct iso_fault *fault)
{
    struct iso_fault why;
    if (iso_stereo_calibration_check(calibration, &why)) {
        return iso_fault_set_code(fault, why.code, -EINVAL, "%s: %s", path, why.text);
    }
    FILE *file = fopen(path, "we");
    if (!file) {
        return iso_fault_set(fault, -errno, "%s: %m", path);
    }
    print_calibration(file, calibration);
    const bool good = !ferror(file);
    if (fclose(file) != 0 || !good) {
        const int error = errno ? -errno : -EIO;
        remove_partial_file(path);
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
    return 0;
}
