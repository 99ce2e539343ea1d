#include "sim/corpus/database.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"
#include "drivers/file/png.h"
#include "sim/corpus/scan_file.h"
#include "sim/corpus/scan_view.h"

typedef int scan_parser(const char *name, const char *bytes, size_t size, struct iso_mesh **out,
                        struct iso_fault *fault);

/* Whether sscanf read all fields and the rest of the name matches. `at` is the index where the rest
 * begins (%n), or 0 if sscanf did not get that far. */
static bool whole_name(const char *file, int fields, int wanted, int at, const char *rest)
{
    return fields == wanted && at > 0 && strcmp(file + at, rest) == 0;
}

static void set_field(char field[SIM_CORPUS_NAME_MAX], const char *prefix, const char *value)
{
    (void)snprintf(field, SIM_CORPUS_NAME_MAX, "%s%s", prefix, value);
}

static int read_scan(const char *path, scan_parser *parse, struct iso_frame **out,
                     struct iso_fault *fault)
{
    char *bytes = NULL;
    size_t size;
    struct iso_mesh *scan = NULL;
    int error = iso_file_read(path, SIM_SCAN_BYTES_MAX, &bytes, &size, fault);
    if (!error) {
        error = parse(path, bytes, size, &scan, fault);
    }
    if (!error && sim_scan_view(scan, out)) {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    iso_mesh_free(scan);
    free(bytes);
    return error;
}

static int read_abs(const char *path, const struct sim_database_options *options,
                    struct iso_frame **out, struct iso_fault *fault)
{
    (void)options;
    return read_scan(path, sim_scan_parse_abs, out, fault);
}

static int read_bnt(const char *path, const struct sim_database_options *options,
                    struct iso_frame **out, struct iso_fault *fault)
{
    (void)options;
    return read_scan(path, sim_scan_parse_bnt, out, fault);
}

static int read_vrml(const char *path, const struct sim_database_options *options,
                     struct iso_frame **out, struct iso_fault *fault)
{
    (void)options;
    return read_scan(path, sim_scan_parse_vrml, out, fault);
}

/* Reads NAME_Portrait.png for NAME_Range.png. Sets *found to false, and returns 0, if there is no
 * such file. */
static int read_portrait(const char *range, struct iso_image *portrait, bool *found,
                         struct iso_fault *fault)
{
    static const char word[] = "Range.png";
    char path[4096];
    const int stem = (int)(strlen(range) - (sizeof word - 1));
    *found = false;
    if (snprintf(path, sizeof path, "%.*sPortrait.png", stem, range) >= (int)sizeof path) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: path too long", range);
    }
    const int error = iso_png_read(path, NULL, portrait, fault);
    *found = error == 0;
    return error == -ENOENT ? 0 : error;
}

static int read_texas(const char *path, const struct sim_database_options *options,
                      struct iso_frame **out, struct iso_fault *fault)
{
    struct iso_image range = {0}, portrait = {0};
    bool found = false;
    int error = iso_png_read(path, NULL, &range, fault);
    if (!error) {
        error = read_portrait(path, &portrait, &found, fault);
    }
    if (!error) {
        error = sim_scan_of_range(&range, found ? &portrait : NULL, options->level_mm, out);
        if (error) {
            error = error == -EINVAL
                        ? iso_fault_set(fault, -EBADMSG,
                                        "%s: range and portrait are not 8-bit pictures of the same "
                                        "size",
                                        path)
                        : iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
        }
    }
    iso_image_done(&range);
    iso_image_done(&portrait);
    return error;
}

/* Clean_0001_001_20050912220400_Range.png: person, session, time. */
static bool describe_texas(const char *file, struct sim_corpus_row *row, bool *neutral)
{
    char person[16], session[16];
    int at = 0;
    const int n = sscanf(file, "%*[A-Za-z]_%15[0-9]_%15[0-9]_%*[0-9]_%n", person, session, &at);
    if (!whole_name(file, n, 2, at, "Range.png")) {
        return false;
    }
    set_field(row->subject, "t", person);
    set_field(row->session, "s", session);
    *neutral = true; /* the names do not contain the expression */
    return true;
}

/* 02463d652.abs: person, recording. */
static bool describe_frgc(const char *file, struct sim_corpus_row *row, bool *neutral)
{
    char person[16], session[16];
    int at = 0;
    const int n = sscanf(file, "%15[0-9]d%15[0-9]%n", person, session, &at);
    if (!whole_name(file, n, 2, at, ".abs")) {
        return false;
    }
    set_field(row->subject, "f", person);
    set_field(row->session, "s", session);
    *neutral = true;
    return true;
}

/* bs000_YR_R10_0.bnt: person, kind (N neutral; E emotion; LFAU, UFAU, CAU action units; YR, PR, CR
 * rotations; O occlusion), which, number. */
static bool describe_bosphorus(const char *file, struct sim_corpus_row *row, bool *neutral)
{
    char person[16], kind[8], which[24], number[8], what[48];
    int at = 0;
    const int n = sscanf(file, "bs%15[0-9]_%7[A-Z]_%23[A-Za-z0-9]_%7[0-9]%n", person, kind, which,
                         number, &at);
    if (!whole_name(file, n, 4, at, ".bnt")) {
        return false;
    }
    const bool turned = strcmp(kind, "YR") == 0 || strcmp(kind, "PR") == 0 ||
                        strcmp(kind, "CR") == 0;
    *neutral = strcmp(kind, "N") == 0;
    (void)snprintf(what, sizeof what, "%s-%s", kind, which);
    set_field(row->subject, "bs", person);
    set_field(row->session, "s", number);
    char *field = kind[0] == 'O' ? row->note : row->expression;
    set_field(turned ? row->pose : field, "", *neutral ? "neutral" : what);
    return true;
}

/* F0001_AN01WH_F3D.wrl: person, emotion and its level, descent. */
static bool describe_bu3dfe(const char *file, struct sim_corpus_row *row, bool *neutral)
{
    char sex[2], person[16], emotion[3], level[3], what[8];
    int at = 0;
    const int n = sscanf(file, "%1[FM]%15[0-9]_%2[A-Z]%2[0-9]%*2[A-Z]_%n", sex, person, emotion,
                         level, &at);
    if (!whole_name(file, n, 4, at, "F3D.wrl")) {
        return false;
    }
    *neutral = strcmp(emotion, "NE") == 0;
    (void)snprintf(what, sizeof what, "%s%s", emotion, level);
    set_field(row->subject, sex, person);
    set_field(row->session, "", what);
    set_field(row->expression, "", *neutral ? "neutral" : what);
    return true;
}

/* cara12_frontal1.wrl: person, and the person's pose or expression. */
static bool describe_gavab(const char *file, struct sim_corpus_row *row, bool *neutral)
{
    char person[16], what[32];
    int at = 0;
    const int n = sscanf(file, "cara%15[0-9]_%31[A-Za-z0-9]%n", person, what, &at);
    if (!whole_name(file, n, 2, at, ".wrl")) {
        return false;
    }
    const bool face = strncmp(what, "risa", 4) == 0 || strncmp(what, "sonrisa", 7) == 0 ||
                      strncmp(what, "gesto", 5) == 0;
    *neutral = strncmp(what, "frontal", 7) == 0;
    set_field(row->subject, "g", person);
    set_field(row->session, "", what);
    set_field(face ? row->expression : row->pose, "", what);
    return true;
}

/* 001-001.wrl: person, number of the scan. */
static bool describe_casia(const char *file, struct sim_corpus_row *row, bool *neutral)
{
    char person[16], session[16];
    int at = 0;
    const int n = sscanf(file, "%15[0-9]-%15[0-9]%n", person, session, &at);
    if (!whole_name(file, n, 2, at, ".wrl")) {
        return false;
    }
    set_field(row->subject, "c", person);
    set_field(row->session, "s", session);
    *neutral = true;
    return true;
}

const struct sim_database sim_database_texas = {
    .name = "texas",
    .source = "Texas 3DFRD (Gupta and others 2010): NAME_Range.png and NAME_Portrait.png",
    .unit_mm = 0.02,
    .describe = describe_texas,
    .read = read_texas,
};
const struct sim_database sim_database_frgc = {
    .name = "frgc",
    .source = "FRGC v2 (Phillips and others 2005): .abs, unpacked",
    .unit_mm = 0.1,
    .describe = describe_frgc,
    .read = read_abs,
};
const struct sim_database sim_database_bosphorus = {
    .name = "bosphorus",
    .source = "Bosphorus (Savran and others 2008): .bnt",
    .unit_mm = 0.1,
    .describe = describe_bosphorus,
    .read = read_bnt,
};
const struct sim_database sim_database_bu3dfe = {
    .name = "bu3dfe",
    .source = "BU-3DFE (Yin and others 2006): _F3D.wrl",
    .unit_mm = 0.1,
    .describe = describe_bu3dfe,
    .read = read_vrml,
};
const struct sim_database sim_database_gavab = {
    .name = "gavab",
    .source = "GavabDB (Moreno and Sanchez 2004): .wrl",
    .unit_mm = 0.1,
    .describe = describe_gavab,
    .read = read_vrml,
};
const struct sim_database sim_database_casia = {
    .name = "casia",
    .source = "CASIA-3D FaceV1 (Zhong, Sun and Tan 2007): .wrl",
    .unit_mm = 0.1,
    .describe = describe_casia,
    .read = read_vrml,
};

const struct sim_database *const sim_databases[] = {
    &sim_database_texas,
    &sim_database_frgc,
    &sim_database_bosphorus,
    &sim_database_bu3dfe,
    &sim_database_gavab,
    &sim_database_casia,
    NULL,
};

const struct sim_database *sim_database_find(const char *name)
{
    for (size_t i = 0; sim_databases[i]; i++) {
        if (strcmp(sim_databases[i]->name, name) == 0) {
            return sim_databases[i];
        }
    }
    return NULL;
}
