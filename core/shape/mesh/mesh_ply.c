/* PLY (Turk 1994). A file is a header, which lists elements and their properties, and the elements
 * as text or as little- or big-endian binary. All three give the same values here. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/text.h"
#include "core/shape/mesh/mesh_build.h"

enum { ELEMENTS_MAX = 16, PROPERTIES_MAX = 64 };

enum type { INT8, UINT8, INT16, UINT16, INT32, UINT32, FLOAT32, FLOAT64, TYPES };

static const struct {
    const char *name, *other_name;
    size_t bytes;
} types[TYPES] = {
    {"char", "int8", 1}, {"uchar", "uint8", 1}, {"short", "int16", 2},   {"ushort", "uint16", 2},
    {"int", "int32", 4}, {"uint", "uint32", 4}, {"float", "float32", 4}, {"double", "float64", 8},
};

/* The meaning of a property. */
enum meaning { NOTHING, X, Y, Z, RED, GREEN, BLUE, CORNERS };

struct property {
    enum type type, count_type;
    bool list;
    enum meaning meaning;
};

struct element {
    bool vertex, face;
    size_t count;
    int n_properties;
    struct property property[PROPERTIES_MAX];
};

enum encoding { TEXT, LITTLE, BIG };

struct ply {
    struct iso__mesh_build *build;
    enum encoding encoding;
    int n_elements;
    struct element element[ELEMENTS_MAX];
    char *at, *end; /* of the unread part */
    unsigned line;  /* number of the line in the header, of the element in the body */
};

static int refuse_file(const struct ply *ply, const char *what, const char *word)
{
    return iso__mesh_build_refuse(ply->build, ply->line, what, word);
}

/* ---- header ---------------------------------------------------------------------- */

static bool type_of(const char *word, enum type *out)
{
    for (int t = 0; t < TYPES; t++) {
        if (strcmp(word, types[t].name) == 0 || strcmp(word, types[t].other_name) == 0) {
            *out = (enum type)t;
            return true;
        }
    }
    return false;
}

static enum meaning meaning_of(const struct element *element, bool list, const char *name)
{
    static const struct {
        const char *name;
        enum meaning meaning;
    } of_vertices[] = {{"x", X},     {"y", Y},         {"z", Z},
                       {"red", RED}, {"green", GREEN}, {"blue", BLUE}};
    if (element->face && list) {
        const bool corners = strcmp(name, "vertex_indices") == 0 ||
                             strcmp(name, "vertex_index") == 0;
        return corners ? CORNERS : NOTHING;
    }
    for (size_t i = 0; element->vertex && !list && i < sizeof of_vertices / sizeof *of_vertices;
         i++) {
        if (strcmp(name, of_vertices[i].name) == 0) {
            return of_vertices[i].meaning;
        }
    }
    return NOTHING;
}

/* "property TYPE NAME" or "property list COUNT_TYPE TYPE NAME". */
static int read_property(struct ply *ply, char **words, size_t n)
{
    const int last = ply->n_elements - 1;
    if (last < 0 || ply->element[last].n_properties == PROPERTIES_MAX) {
        return refuse_file(ply, "a property too many:", words[n - 1]);
    }
    struct element *element = &ply->element[last];
    struct property property = {.list = n == 5 && strcmp(words[1], "list") == 0};
    const bool known = property.list ? type_of(words[2], &property.count_type) &&
                                           type_of(words[3], &property.type)
                                     : n == 3 && type_of(words[1], &property.type);
    if (!known || (property.list && property.count_type >= FLOAT32)) {
        return refuse_file(ply, "bad type of property", words[n - 1]);
    }
    property.meaning = meaning_of(element, property.list, words[n - 1]);
    for (int p = 0; property.meaning != NOTHING && p < element->n_properties; p++) {
        if (element->property[p].meaning == property.meaning) {
            return refuse_file(ply, "a second property", words[n - 1]);
        }
    }
    element->property[element->n_properties++] = property;
    return 0;
}

static int read_element(struct ply *ply, char **words, size_t n)
{
    struct element *element = &ply->element[ply->n_elements];
    if (ply->n_elements == ELEMENTS_MAX || n != 3 || iso_text_count(words[2], &element->count) ||
        element->count > (size_t)ISO__MESH_MOST) {
        return refuse_file(ply, "bad element", words[n - 1]);
    }
    element->vertex = strcmp(words[1], "vertex") == 0;
    element->face = strcmp(words[1], "face") == 0;
    ply->n_elements++;
    return 0;
}

static int read_format(struct ply *ply, const char *word)
{
    static const char *const names[] = {
        [TEXT] = "ascii", [LITTLE] = "binary_little_endian", [BIG] = "binary_big_endian"};
    for (int i = TEXT; i <= BIG; i++) {
        if (strcmp(word, names[i]) == 0) {
            ply->encoding = (enum encoding)i;
            return 0;
        }
    }
    return refuse_file(ply, "unknown format", word);
}

/* Takes the next line of the header, without its end; NULL at the end of the file. */
static char *header_line(struct ply *ply)
{
    char *line = ply->at, *end = memchr(line, '\n', (size_t)(ply->end - line));
    if (!end) {
        return NULL;
    }
    ply->at = end + 1;
    ply->line++;
    if (end > line && end[-1] == '\r') {
        end--;
    }
    *end = '\0';
    return line;
}

static int read_header(struct ply *ply)
{
    char *line = header_line(ply), *words[5];
    bool format = false;
    if (!line || strcmp(line, "ply") != 0) {
        return iso_fault_set(ply->build->fault, -EBADMSG, "%s:1: does not begin with ply",
                             ply->build->name);
    }
    while ((line = header_line(ply))) {
        const size_t n = iso_text_words(line, words, 5);
        int error = 0;
        if (n == 0 || strcmp(words[0], "comment") == 0 || strcmp(words[0], "obj_info") == 0) {
            continue;
        }
        if (strcmp(words[0], "end_header") == 0) {
            return format ? 0 : refuse_file(ply, "no format before", words[0]);
        }
        if (strcmp(words[0], "format") == 0 && n == 3 && !format) {
            error = read_format(ply, words[1]);
            format = true;
        } else if (strcmp(words[0], "element") == 0) {
            error = read_element(ply, words, n < 5 ? n : 5);
        } else if (strcmp(words[0], "property") == 0 && n <= 5) {
            error = read_property(ply, words, n);
        } else {
            error = refuse_file(ply, "not a line of a header:", words[0]);
        }
        if (error) {
            return error;
        }
    }
    return iso_fault_set(ply->build->fault, -EBADMSG, "%s: no end_header", ply->build->name);
}

/* ---- body ------------------------------------------------------------------------ */

static int ends_early(const struct ply *ply)
{
    return iso_fault_set(ply->build->fault, -EBADMSG, "%s: ends within element %u",
                         ply->build->name, ply->line);
}

static uint64_t read_bits(const struct ply *ply, size_t n)
{
    uint64_t bits = 0;
    for (size_t i = 0; i < n; i++) {
        const size_t from = ply->encoding == LITTLE ? n - 1 - i : i;
        bits = bits << 8 | (uint8_t)ply->at[from];
    }
    return bits;
}

static double value_of(enum type type, uint64_t bits)
{
    float single;
    double twice;
    uint32_t word = (uint32_t)bits;
    switch (type) {
    case INT8:
        return (int8_t)bits;
    case INT16:
        return (int16_t)bits;
    case INT32:
        return (int32_t)bits;
    case FLOAT32:
        memcpy(&single, &word, sizeof single);
        return (double)single;
    case FLOAT64:
        memcpy(&twice, &bits, sizeof twice);
        return twice;
    default:
        return (double)bits;
    }
}

/* Reads the next value in any encoding. Texts are read word by word, as most readers do. */
static int read_value(struct ply *ply, enum type type, double *out)
{
    if (ply->encoding != TEXT) {
        if ((size_t)(ply->end - ply->at) < types[type].bytes) {
            return ends_early(ply);
        }
        *out = value_of(type, read_bits(ply, types[type].bytes));
        ply->at += types[type].bytes;
        return isfinite(*out) ? 0 : refuse_file(ply, "a value is", "not finite");
    }
    char *word = ply->at + strspn(ply->at, " \t\r\n"), *end = word + strcspn(word, " \t\r\n");
    if (*word == '\0') {
        return ends_early(ply);
    }
    ply->at = *end ? end + 1 : end;
    *end = '\0';
    return iso_text_number(word, out) ? refuse_file(ply, "bad value", word) : 0;
}

static int read_list(struct ply *ply, const struct property *property)
{
    double count, value;
    int32_t corner[3];
    const bool corners = property->meaning == CORNERS;
    int error = read_value(ply, property->count_type, &count);
    if (!error && !(count >= (corners ? 3.0 : 0.0) && count <= (double)ISO__MESH_CORNERS_MOST)) {
        return refuse_file(ply, "bad length of", "a list");
    }
    for (int i = 0; !error && i < (int)count; i++) {
        error = read_value(ply, property->type, &value);
        if (error || !corners) {
            continue;
        }
        if (!(value >= 0.0 && value < (double)ISO__MESH_MOST && floor(value) == value)) {
            return refuse_file(ply, "bad corner of", "a face");
        }
        corner[i < 2 ? i : 2] = (int32_t)value;
        if (i >= 2) {
            error = iso__mesh_build_triangle(ply->build, ply->line, corner);
            corner[1] = corner[2];
        }
    }
    return error;
}

/* The greatest value of a colour channel: that of the type for one or two unsigned bytes, otherwise
 * 1. */
static double full_scale(enum type type)
{
    if (type == UINT8) {
        return 255.0;
    }
    return type == UINT16 ? 65535.0 : 1.0;
}

static int read_one(struct ply *ply, const struct element *element)
{
    double value[CORNERS + 1] = {0.0};
    bool coloured = false;
    for (int p = 0; p < element->n_properties; p++) {
        const struct property *property = &element->property[p];
        const double full = full_scale(property->type);
        const int error = property->list
                              ? read_list(ply, property)
                              : read_value(ply, property->type, &value[property->meaning]);
        if (error) {
            return error;
        }
        if (property->meaning >= RED && property->meaning <= BLUE) {
            coloured = true;
            value[property->meaning] /= full;
            if (!(value[property->meaning] >= 0.0 && value[property->meaning] <= 1.0)) {
                return refuse_file(ply, "bad colour of", "a vertex");
            }
        }
    }
    if (!element->vertex) {
        return 0;
    }
    struct iso_colour colour = {{(float)value[RED], (float)value[GREEN], (float)value[BLUE]}};
    return iso__mesh_build_vertex(ply->build, ply->line, iso_vec3(value[X], value[Y], value[Z]),
                                  coloured ? &colour : NULL);
}

static bool has_property(const struct element *element, enum meaning meaning)
{
    for (int p = 0; p < element->n_properties; p++) {
        if (element->property[p].meaning == meaning) {
            return true;
        }
    }
    return false;
}

static int read_body(struct ply *ply)
{
    int vertices = 0, faces = 0;
    for (int e = 0; e < ply->n_elements; e++) {
        const struct element *element = &ply->element[e];
        vertices += element->vertex && has_property(element, X) && has_property(element, Y) &&
                    has_property(element, Z);
        faces += element->face && has_property(element, CORNERS);
    }
    if (vertices != 1 || faces > 1 || (faces < 1 && !ply->build->points)) {
        return iso_fault_set(ply->build->fault, -EBADMSG,
                             "%s: not one element each of vertices "
                             "with x, y, z and of faces with vertex_indices",
                             ply->build->name);
    }
    for (int e = 0; e < ply->n_elements; e++) {
        for (size_t i = 0; i < ply->element[e].count && ply->element[e].n_properties > 0; i++) {
            ply->line = (unsigned)i + 1;
            const int error = read_one(ply, &ply->element[e]);
            if (error) {
                return error;
            }
        }
    }
    ply->at += ply->encoding == TEXT ? strspn(ply->at, " \t\r\n") : 0;
    return ply->at == ply->end ? 0
                               : iso_fault_set(ply->build->fault, -EBADMSG,
                                               "%s: more than was announced", ply->build->name);
}

int iso__mesh_read_ply(struct iso__mesh_build *build, char *bytes, size_t size)
{
    struct ply *ply = calloc(1, sizeof *ply);
    if (!ply) {
        return iso_fault_set(build->fault, -ENOMEM, "%s: out of memory", build->name);
    }
    ply->build = build;
    ply->at = bytes;
    ply->end = bytes + size;
    int error = read_header(ply);
    if (!error) {
        error = read_body(ply);
    }
    free(ply);
    return error;
}
