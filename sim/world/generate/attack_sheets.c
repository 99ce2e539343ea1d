/* Flat instruments: photographs and screens. */
#include <stdio.h>

#include "sim/world/generate/attack_scenes.h"
#include "sim/world/prop/hand.h"
#include "sim/world/prop/screen.h"
#include "sim/world/prop/sheet.h"

#define DEGREES(x) ((x)*0.017453292519943295)

/* Width of the edge that a hand covers, and position of the edge in the hand's frame
 * (sim/world/prop/hand.h). */
static const double grip_mm = 14.0, grip_y_mm = -70.0;
/* The largest angle between the middle of a rolled sheet and its edge. The first limit is for a
 * sheet that is rolled away from the camera. The second limit is for a sheet that is rolled towards
 * the camera or bent like an S: beyond it, the sheet covers a part of its own picture. */
static const double roll_limit_rad = 2.2, hollow_limit_rad = 1.3;

/* A random pose of a sheet that is held towards the camera, not quite straight. */
static struct iso_rigid camera_from_flat(const struct sim_staging *staging)
{
    const double pitch = sim_staging_pitch(staging, 18.0);
    const double yaw = sim_staging_yaw(staging, 20.0);
    const double roll = DEGREES(8.0) * sim_random_normal(staging->random);
    struct iso_mat3 turn = iso_mat3_rotation(iso_vec3(0.0, 0.0, roll));
    struct iso_mat3 tilt = iso_mat3_rotation(iso_vec3(pitch, yaw, 0.0));
    return (struct iso_rigid){iso_mat3_mul(&tilt, &turn), sim_staging_place(staging)};
}

/* The held object: a sheet's surface, and the thickness of the object behind it. */
struct held {
    struct sim_sheet surface;
    double behind_mm;
    double reach_mm; /* greatest distance of a hand from the middle of the lower edge */
};

/* Greatest distance of a bent sheet from its tangent plane at (x, y), on the far side, where the
 * fingers of a hand at this point lie. */
static double sagitta_at(const struct sim_sheet *surface, double x_mm, double y_mm,
                         const struct iso_rigid *flat_from_edge)
{
    struct iso_rigid edge_from_flat = iso_rigid_inverse(flat_from_edge);
    double most = 0.0;
    for (int dx = -40; dx <= 40; dx += 10) {
        for (int dy = -100; dy <= 0; dy += 20) {
            struct iso_vec3 p = sim_sheet_point(surface, x_mm + dx, y_mm + dy);
            most = fmax(most, iso_rigid_apply(&edge_from_flat, p).z);
        }
    }
    return most;
}

/* Adds a hand at a point of the lower edge, aligned with the sheet there. */
static void add_hand(struct sim_staging *staging, const struct iso_rigid *camera_from_flat,
                     const struct held *held, double x_mm)
{
    const struct sim_sheet *surface = &held->surface;
    const double y_mm = 0.5 * surface->height_mm;
    struct iso_vec3 edge = sim_sheet_point(surface, x_mm, y_mm);
    struct iso_vec3 right = iso_unit(iso_sub(sim_sheet_point(surface, x_mm + 1.0, y_mm), edge));
    struct iso_vec3 down = iso_sub(sim_sheet_point(surface, x_mm, y_mm + 1.0), edge);
    struct iso_vec3 away = iso_unit(iso_cross(right, down));
    down = iso_cross(away, right);
    struct iso_rigid flat_from_edge = {
        {{{right.x, down.x, away.x}, {right.y, down.y, away.y}, {right.z, down.z, away.z}}}, edge};
    const double thick = held->behind_mm + sagitta_at(surface, x_mm, y_mm, &flat_from_edge);
    struct iso_rigid wrist = {iso_mat3_identity(), {0.0, -grip_y_mm - grip_mm, 0.0}};
    struct iso_rigid flat_from_wrist = iso_rigid_mul(&flat_from_edge, &wrist);
    struct sim_group *things = staging->still->things;
    things->placed = iso_rigid_mul(camera_from_flat, &flat_from_wrist);
    const bool left = sim_staging_chance(staging, 0.5);
    sim_hand_add(things, SIM_HAND_GRIP, left, thick, staging->random);
}

/* Adds a person whose face is behind the instrument, seen from the camera. */
static int add_bearer(struct sim_staging *staging, struct iso_vec3 middle_mm)
{
    struct sim_random *random = staging->random;
    const double gap = sim_random_between(random, 110.0, 200.0);
    struct sim_stance stance = {.nose_mm = iso_scale(1.0 + gap / middle_mm.z, middle_mm)};
    stance.yaw_rad = sim_random_between(random, -0.15, 0.15);
    stance.pitch_rad = sim_random_between(random, -0.1, 0.1);
    stance.nose_mm.x += sim_random_between(random, -12.0, 12.0);
    stance.nose_mm.y += sim_random_between(random, -10.0, 20.0);
    return sim_still_add_person(staging->still, staging->ict, "bearers", true, &stance, random);
}

/* Adds a hand from below (sometimes one on either side), with its owner behind the instrument or
 * out of sight; or a stand. */
static int hold_sheet(struct sim_staging *staging, const struct iso_rigid *camera_from_flat,
                      const struct held *held)
{
    if (sim_staging_chance(staging, 0.2)) {
        struct iso_vec3 back = {0.0, 0.0, 12.0 + held->behind_mm};
        sim_staging_add_pole(staging, iso_rigid_apply(camera_from_flat, back), 8.0);
        return 0;
    }
    const bool both = held->reach_mm > 60.0 && sim_staging_chance(staging, 0.3);
    const double x = both ? held->reach_mm
                          : sim_random_between(staging->random, -held->reach_mm, held->reach_mm);
    add_hand(staging, camera_from_flat, held, x);
    if (both) {
        add_hand(staging, camera_from_flat, held, -x);
    }
    if (sim_staging_chance(staging, 0.5)) {
        return add_bearer(staging, camera_from_flat->translation_mm);
    }
    return 0;
}

/* ---- photographs ------------------------------------------------------------ */

static const struct format {
    const char *name;
    double width_mm, height_mm;
} formats[] = {
    {"a5", 148.0, 210.0}, {"b5", 176.0, 250.0}, {"a4", 210.0, 297.0}, {"a3", 297.0, 420.0}};

static const struct format *draw_format(struct sim_staging *staging, struct sim_sheet *sheet)
{
    const uint32_t n = sizeof formats / sizeof *formats;
    const struct format *format = &formats[sim_random_below(staging->random, n)];
    const bool lying = sim_staging_chance(staging, 0.15);
    sheet->width_mm = lying ? format->height_mm : format->width_mm;
    sheet->height_mm = lying ? format->width_mm : format->height_mm;
    return format;
}

static int show_sheet(struct sim_staging *staging, const struct sim_sheet *sheet)
{
    struct sim_group *things = staging->still->things;
    struct sim_solid *solid = NULL;
    struct iso_rigid camera_from_sheet = camera_from_flat(staging);
    things->placed = camera_from_sheet;
    const int made = sim_sheet_new(sheet, SIM_PAPER, &solid);
    sim_group_add(things, made, solid);
    struct held held = {*sheet, 0.0, sheet->outline ? 0.0 : 0.35 * sheet->width_mm};
    return hold_sheet(staging, &camera_from_sheet, &held);
}

int sim_attack_photo_flat(struct sim_staging *staging)
{
    struct sim_sheet sheet = {.key = sim_random_u64(staging->random)};
    const struct format *format = draw_format(staging, &sheet);
    const bool board = sim_staging_chance(staging, 0.5);
    sheet.waves_mm = board ? 0.0 : sim_random_between(staging->random, 0.1, 0.6);
    sheet.outline = sim_staging_chance(staging, 0.25);
    if (sheet.outline) { /* a head of about life size */
        sheet.width_mm = sim_random_between(staging->random, 140.0, 190.0);
        sheet.height_mm = sheet.width_mm * sim_random_between(staging->random, 1.3, 1.5);
    }
    (void)snprintf(staging->variant, sizeof staging->variant, "%s-%s",
                   sheet.outline ? "cut" : format->name, board ? "board" : "paper");
    return show_sheet(staging, &sheet);
}

/* Half the sheet's extent across the axis. */
static double half_span(const struct sim_sheet *sheet)
{
    return 0.5 * (sheet->width_mm * fabs(cos(sheet->axis_rad)) +
                  sheet->height_mm * fabs(sin(sheet->axis_rad)));
}

int sim_attack_photo_bent(struct sim_staging *staging)
{
    struct sim_random *random = staging->random;
    struct sim_sheet sheet = {.key = sim_random_u64(random)};
    const double luck = sim_random_unit(random);
    sheet.shape = luck < 0.6 ? SIM_SHEET_ROLLED : SIM_SHEET_S;
    if (luck >= 0.8) {
        sheet.shape = SIM_SHEET_CREASED;
    }
    sheet.radius_mm = 60.0 * pow(5.0, sim_random_unit(random));
    sheet.crease_rad = DEGREES(sim_random_between(random, 12.0, 40.0));
    const bool slanted = sim_staging_chance(staging, 0.5),
               hollow = sim_staging_chance(staging, 0.25);
    const double lean = slanted ? 45.0 : 3.0;
    sheet.axis_rad = DEGREES(sim_random_between(random, -lean, lean));
    sheet.waves_mm = sim_random_between(random, 0.0, 0.6);
    (void)draw_format(staging, &sheet);
    const double limit = hollow || sheet.shape == SIM_SHEET_S ? hollow_limit_rad : roll_limit_rad;
    while (sheet.shape != SIM_SHEET_CREASED && half_span(&sheet) > limit * sheet.radius_mm) {
        sheet.width_mm *= 0.9;
        sheet.height_mm *= 0.9;
    }
    if (sheet.shape == SIM_SHEET_CREASED) {
        (void)snprintf(staging->variant, sizeof staging->variant, "creased-%s%.0fdeg",
                       hollow ? "hollow-" : "", sheet.crease_rad / DEGREES(1.0));
    } else {
        (void)snprintf(staging->variant, sizeof staging->variant, "%s-%sr%.0f",
                       sheet.shape == SIM_SHEET_S ? "s" : "rolled", hollow ? "hollow-" : "",
                       sheet.radius_mm);
    }
    sheet.radius_mm *= hollow ? -1.0 : 1.0;
    sheet.crease_rad *= hollow ? -1.0 : 1.0;
    return show_sheet(staging, &sheet);
}

/* ---- screens ---------------------------------------------------------------- */

static const struct device {
    const char *name;
    struct sim_screen screen;
} devices[] = {
    {"phone", {.width_mm = 68.0, .height_mm = 148.0, .rim_mm = 3.0, .thickness_mm = 8.5}},
    {"tablet", {.width_mm = 166.0, .height_mm = 236.0, .rim_mm = 9.0, .thickness_mm = 7.0}},
    {"laptop",
     {.width_mm = 312.0,
      .height_mm = 196.0,
      .rim_mm = 11.0,
      .thickness_mm = 7.0,
      .keyboard = true}},
};

int sim_attack_screen(struct sim_staging *staging)
{
    struct sim_random *random = staging->random;
    const uint32_t n = sizeof devices / sizeof *devices;
    const struct device *device = &devices[sim_random_below(random, n)];
    struct sim_screen screen = device->screen;
    const double size = sim_random_between(random, 0.9, 1.12);
    screen.width_mm *= size;
    screen.height_mm *= size;
    screen.lost = sim_random_between(random, 0.02, 0.98);
    screen.patch_mm = sim_random_between(random, 15.0, 80.0);
    const bool deep = sim_staging_chance(staging, 0.6);
    screen.behind_mm = deep ? sim_random_between(random, 3.0, 45.0) : 0.0;
    screen.key = sim_random_u64(random);
    (void)snprintf(staging->variant, sizeof staging->variant, "%s-lost%.0f-behind%.0f",
                   device->name, 100.0 * screen.lost, screen.behind_mm);
    struct iso_rigid camera_from_screen = camera_from_flat(staging);
    staging->still->things->placed = camera_from_screen;
    sim_screen_add(staging->still->things, &screen);
    if (screen.keyboard) { /* it stands on a surface below the picture */
        return sim_staging_chance(staging, 0.5)
                   ? add_bearer(staging, camera_from_screen.translation_mm)
                   : 0;
    }
    struct held held = {
        .surface = {.width_mm = screen.width_mm,
                    .height_mm = screen.height_mm + 2.0 * screen.rim_mm},
        .behind_mm = fmax(screen.thickness_mm, screen.behind_mm),
        .reach_mm = 0.3 * screen.width_mm,
    };
    return hold_sheet(staging, &camera_from_screen, &held);
}
