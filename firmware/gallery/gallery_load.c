/* Reads the gallery from the disk (gallery.h). */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/wipe.h"
#include "firmware/gallery/gallery_seal.h"
#include "firmware/gallery/gallery_state.h"
#include "firmware/site/site_batch.h"

/* Vectors are stored only if a start had to make MADE_MIN of them or more, because to make fewer
 * takes less time than the disk needs. A start stores MADE_MAX at most, which take 18 MB of memory
 * meanwhile; the next start stores more. */
enum { MADE_MIN = 100, MADE_MAX = 256 * MADE_MIN };

/* The vectors that were made while the gallery was read. */
struct made {
    bool wanted;
    struct iso_gallery_vector *vectors;
    size_t n, capacity;
};

struct loading {
    struct iso_gallery_db *db;
    struct iso_site_batch *batch; /* with a metric: what adds the vectors */
    const struct iso_work_listener *listener;
    struct iso_gallery_memory memory;
    struct made made;
};

/* ---- the vectors that are made ---- */

/* Notes a vector that the batch has made. Without memory it is not noted, and is made again at the
 * next start. */
static void note_made(void *context, int64_t number, bool learned, const char *sensor,
                      const struct iso_metric_vector *vector)
{
    struct made *made = context;
    if (made->n == made->capacity) {
        const size_t more = made->capacity ? 2 * made->capacity : MADE_MIN;
        struct iso_gallery_vector *grown = more > MADE_MAX ? NULL
                                                           : iso_wipe_grow(made->vectors, made->n,
                                                                           more, sizeof *grown);
        if (!grown) {
            return;
        }
        made->vectors = grown;
        made->capacity = more;
    }
    struct iso_gallery_vector *own = &made->vectors[made->n++];
    own->number = number;
    own->learned = learned;
    own->vector = *vector;
    memcpy(own->sensor, sensor, sizeof own->sensor);
}

static void forget_made(struct made *made)
{
    iso_wipe_free(made->vectors);
    *made = (struct made){.wanted = false};
}

/* ---- people and templates ---- */

static int load_person(void *context, const struct iso_person *person, struct iso_fault *fault)
{
    struct iso_gallery_memory *memory = &((struct loading *)context)->memory;
    if (iso_gallery_memory_reserve_people(memory, 1)) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    struct iso_person *own = &memory->people[memory->n_people];
    *own = *person;
    if (iso_person_name_key(own->name, &own->key)) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    memory->n_people++;
    return 0;
}

/* Loads a template that the running algorithm can use. */
static int load_usable(struct loading *loading, struct iso_person *person, int64_t number,
                       const void *bytes, size_t size)
{
    struct iso_gallery_kept kept;
    int error = loading->batch ? iso_site_batch_add(loading->batch, person->id, number, bytes, size)
                               : iso__gallery_memory_read(&loading->memory, bytes, size, &kept);
    if (!error && !loading->batch) {
        loading->memory.may_be_learned |= kept.tmpl->learned;
        error = iso__gallery_memory_insert(&loading->memory, person->id, &kept);
    }
    person->usable += !error;
    return error;
}

/* Checks that the bytes are a template of this algorithm, which is not the running one. */
static int check_unusable(struct loading *loading, const void *bytes, size_t size,
                          uint32_t algorithm)
{
    struct iso_template_facts facts;
    const int error = iso_template_check(bytes, size, &facts);
    if (error) {
        return error;
    }
    loading->memory.may_be_learned |= facts.learned;
    return facts.algorithm == algorithm ? 0 : -EBADMSG;
}

/* What the error of a template means for loading. */
static int template_result(const struct loading *loading, int error, struct iso_fault *fault)
{
    if (error == -ENOMEM) {
        return iso_fault_set(fault, error, "gallery: out of memory");
    }
    const bool damaged = error && error != -EPROTONOSUPPORT;
    return damaged ? iso_gallery_db_damaged(loading->db, "a template cannot be read", fault) : 0;
}

/* Counts a template to its person. NULL with *fault set if there is no such person. */
static struct iso_person *count_template(struct loading *loading,
                                         const struct iso_gallery_place *place,
                                         struct iso_fault *fault)
{
    struct iso_person *person = iso_gallery_memory_find(&loading->memory, place->person);
    if (!person) {
        (void)iso_gallery_db_damaged(loading->db, "a template belongs to nobody", fault);
        return NULL;
    }
    person->templates++;
    iso_work_step(loading->listener, (uint64_t)(person - loading->memory.people) + 1,
                  loading->memory.n_people);
    return person;
}

static int load_template(void *context, const struct iso_gallery_place *place, const void *bytes,
                         size_t size, struct iso_fault *fault)
{
    struct loading *loading = context;
    struct iso_person *person = count_template(loading, place, fault);
    if (!person) {
        return -EBADMSG;
    }
    const int error = place->algorithm == loading->memory.algorithm
                          ? load_usable(loading, person, place->number, bytes, size)
                          : check_unusable(loading, bytes, size, place->algorithm);
    return template_result(loading, error, fault);
}

/* Loads a template by its stored vector. */
static int load_vector(void *context, const struct iso_gallery_place *place,
                       const struct iso_gallery_vector *stored, struct iso_fault *fault)
{
    struct loading *loading = context;
    struct iso_person *person = count_template(loading, place, fault);
    if (!person) {
        return -EBADMSG;
    }
    const int error = iso_site_batch_add_vector(loading->batch, person->id, stored->number,
                                                stored->sensor, &stored->vector);
    person->usable += !error;
    loading->memory.may_be_learned |= stored->learned;
    return template_result(loading, error, fault);
}

static int load_access(void *context, const struct iso_gallery_place *place, const void *bytes,
                       size_t size, struct iso_fault *fault)
{
    struct loading *loading = context;
    if (place->person != ISO_GALLERY_SITE && place->person != ISO_GALLERY_FLEET &&
        !iso_gallery_memory_find(&loading->memory, place->person)) {
        return iso_gallery_db_damaged(loading->db, "an access record belongs to nobody", fault);
    }
    const int error = iso_gallery_access_load(&loading->memory.access, place->person,
                                              place->algorithm, bytes, size);
    if (error == -ENOMEM) {
        return iso_fault_set(fault, error, "gallery: out of memory");
    }
    return error ? iso_gallery_db_damaged(loading->db, "an access record is not whole", fault) : 0;
}

/* Sorts by key, and people with the same key by spelling. */
static int by_name(const void *a, const void *b)
{
    const struct iso_person *one = *(const struct iso_person *const *)a;
    const struct iso_person *other = *(const struct iso_person *const *)b;
    const int order = memcmp(&one->key, &other->key, sizeof one->key);
    return order ? order : strcmp(one->name, other->name);
}

/* Two people cannot have the same spelling. They can have two spellings of one name in a gallery
 * that was written when the case of letters made a difference. Such people stay, and are
 * counted. */
static int check_names(struct loading *loading, struct iso_fault *fault)
{
    struct iso_gallery_memory *memory = &loading->memory;
    const size_t n = memory->n_people;
    int error = 0;
    const struct iso_person **people = calloc(n ? n : 1, sizeof *people);
    if (!people) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    for (size_t i = 0; i < n; i++) {
        people[i] = &memory->people[i];
    }
    qsort(people, n, sizeof *people, by_name);
    for (size_t i = 1; i < n && !error; i++) {
        if (strcmp(people[i - 1]->name, people[i]->name) == 0) {
            error = iso_gallery_db_damaged(loading->db, "two people of one name", fault);
        }
        memory->same_names += iso_person_name_key_is_same(&people[i - 1]->key, &people[i]->key);
    }
    free(people);
    return error;
}

/* Makes the index that is to be filled, and what fills it. */
static int begin_index(struct loading *loading)
{
    struct iso_gallery_memory *memory = &loading->memory;
    int error = iso_site_index_new(memory->metric, memory->adapt, &memory->site);
    if (!error) {
        error = iso_site_batch_new(memory->site, memory->algorithm, memory->metric,
                                   &loading->batch);
    }
    if (!error && loading->made.wanted) {
        iso_site_batch_tell(loading->batch, note_made, &loading->made);
    }
    return error;
}

/* Reads everything, and checks what can be checked when all is read. */
static int read_all(struct loading *loading, struct iso_fault *fault)
{
    struct iso_gallery_memory *memory = &loading->memory;
    const struct iso_gallery_visitor visitor = {.person = load_person,
                                                .template = load_template,
                                                .access = load_access,
                                                .vector = memory->metric ? load_vector : NULL,
                                                .context = loading};
    int error = iso_gallery_db_load(loading->db, &visitor, fault);
    if (!error && memory->metric) {
        error = template_result(loading, iso_site_batch_end(loading->batch), fault);
        memory->may_be_learned |= iso_site_batch_learned(loading->batch);
    }
    if (!error) {
        error = check_names(loading, fault);
    }
    if (!error && memory->metric) {
        iso_site_index_set_record(memory->site, iso_gallery_db_site(loading->db));
        error = iso_site_index_start(memory->site)
                    ? iso_fault_set(fault, -ENOMEM, "gallery: no memory for a thread")
                    : 0;
    }
    return error;
}

/* `loading` says what to load and how; loading->memory is written on success. */
static int load(struct loading *loading, struct iso_fault *fault)
{
    int error = 0;
    if (loading->memory.metric && begin_index(loading)) {
        error = iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    if (!error) {
        error = read_all(loading, fault);
    }
    iso_site_batch_free(loading->batch);
    if (error) {
        forget_made(&loading->made);
        iso_gallery_memory_done(&loading->memory);
    }
    return error;
}

int iso_gallery_memory_load(struct iso_gallery_db *db, uint32_t algorithm,
                            const struct iso_metric *metric, bool adapt,
                            const struct iso_work_listener *listener,
                            struct iso_gallery_memory *out, struct iso_fault *fault)
{
    struct loading loading = {
        .db = db,
        .listener = listener,
        .memory = {.algorithm = algorithm, .metric = metric, .adapt = adapt},
    };
    const int error = load(&loading, fault);
    if (!error) {
        *out = loading.memory;
    }
    return error;
}

int iso_gallery_memory_start(struct iso_gallery_db *db, const struct iso_gallery_options *options,
                             struct iso_gallery_memory *out, struct iso_fault *fault)
{
    struct loading loading = {
        .db = db,
        .memory = {.algorithm = options->algorithm,
                   .metric = options->metric,
                   .adapt = options->adapt},
        .made = {.wanted = true},
    };
    const int error = load(&loading, fault);
    if (error) {
        return error;
    }
    if (loading.made.n >= MADE_MIN) {
        iso_gallery_db_store_vectors(db, loading.made.vectors, loading.made.n);
    }
    forget_made(&loading.made);
    *out = loading.memory;
    return 0;
}
