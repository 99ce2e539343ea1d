/* An index of the people of a site, by a metric that is adapted to them (core/match/site.h).
 *
 * The index itself is by the shipped metric: it finds the people who look most like a probe. The
 * adapted metric then gives these few people their scores (iso_site_index_person). So there is only
 * one index, and a new metric needs no new one.
 *
 * This object keeps the vectors of all templates by the shipped metric. After every change of
 * people, its thread computes the statistics of the site from all vectors, and then the adapted
 * metric. Until it is complete, searches use the metric before. iso_site_index_follow() takes the
 * new metric into use. So a search never waits for the thread.
 *
 * Only templates that were made before the running class of sensor teach the metric
 * (iso_site_index_set_sensor), because what people have in common before one sensor is wrong before
 * another (sim/results/site.md). All others identify their people just the same.
 *
 * The result depends only on the templates that are enrolled now, and on which of them may teach.
 * It does not depend on the order in which people were added and removed, and contains nothing of
 * removed people. If it cannot be computed, searches go on with the metric of before; but if that
 * has learned from somebody who was removed, or from templates that teach no more, they go back to
 * the shipped metric.
 *
 * If there are fewer than ISO_SITE_PEOPLE_MIN people, searches use the shipped metric. Without
 * `adapt` they always do; then there is no thread, and the vectors are not kept.
 *
 * One thread calls these functions. Biometric data: wiped when it is moved, removed or freed. */
#ifndef ISO_FIRMWARE_SITE_SITE_INDEX_H
#define ISO_FIRMWARE_SITE_SITE_INDEX_H

#include <stdbool.h>
#include <stdint.h>

#include "core/match/site.h"
#include "firmware/site/site_estimate.h"
#include "firmware/site/site_record.h"
#include "isotherm/index.h"

enum {
    ISO_SITE_PEOPLE_MIN = 3, /* the offset of fewer people is mostly that of their own faces */
    /* Of more people, those with the lowest numbers teach the metric: enough to know the site, and
     * little enough for the memory of a board. */
    ISO_SITE_PEOPLE_MAX = 2000,
};

struct iso_site_index;

/* What the site has taught. */
struct iso_site_state {
    bool adapts;  /* the metric adapts to the site */
    bool adapted; /* searches use an adapted metric; false: the shipped one */
    bool due;     /* people have changed since; a new metric is being computed */
    int error;    /* why the last computation failed: -ENOMEM, -EDOM, -EINVAL; 0: it did not */
    struct iso_site_summary summary; /* of the generation in use; all zero without `adapts` */
};

/* Makes an empty index. `metric` is the shipped one, and outlives the index. -ENOMEM. */
int iso_site_index_new(const struct iso_metric *metric, bool adapt, struct iso_site_index **out)
    __attribute__((warn_unused_result));

/* Starts the thread, after the people of a gallery were added. Until then nothing is adapted.
 * Without `adapt` it does nothing. -EAGAIN, -ENOMEM. */
int iso_site_index_start(struct iso_site_index *site) __attribute__((warn_unused_result));

/* Ends the thread; wipes and frees everything. NULL is accepted. */
void iso_site_index_free(struct iso_site_index *site);

/* Makes room for n more templates (1 or more), of one person or of several. -ENOMEM. */
int iso_site_index_reserve(struct iso_site_index *site, size_t n)
    __attribute__((warn_unused_result));

/* Adds the vector of one template of a person; the vector is by the shipped metric, `number` is
 * that of the template (site_record.h), and `sensor` is what the template stores of its sensor.
 * Before, the caller has made room with iso_site_index_reserve(). -EINVAL if the person already has
 * ISO_INDEX_TEMPLATES_MAX templates; then nothing has changed. */
int iso_site_index_add(struct iso_site_index *site, int64_t person, uint64_t number,
                       const char *sensor, const struct iso_metric_vector *vector)
    __attribute__((warn_unused_result));

/* Removes a person with all vectors. Nothing happens for a person who has none. */
void iso_site_index_remove(struct iso_site_index *site, int64_t person);

/* Sets which templates teach the metric. At first all do. Templates that do not teach identify
 * their person as before, and change no number of the statistics. */
void iso_site_index_set_record(struct iso_site_index *site, const struct iso_site_record *record);

/* Sets the class of the running sensor (struct iso_site_teaching): its model; "" and before the
 * first call: not known, and templates of every class teach. If other templates teach now, searches
 * use the shipped metric until the new one is complete. Costs nothing if the class is the same. */
void iso_site_index_set_sensor(struct iso_site_index *site, const char *sensor);

/* Whether a person does not teach because none of the person's templates is of the running
 * class. */
bool iso_site_index_is_other(const struct iso_site_index *site, int64_t person);

/* Counts the templates with at least this number that teach by the record, or (`teaching` false)
 * those that do not. 0 without `adapt`. */
size_t iso_site_index_count(struct iso_site_index *site, uint64_t first, bool teaching);

/* Takes a new metric into use, if it is complete. Returns whether it did. Never waits. */
bool iso_site_index_follow(struct iso_site_index *site);

/* The index to search in, by the shipped metric. Valid until people change. */
const struct iso_index *iso_site_index_current(const struct iso_site_index *site);

/* The adapted metric in use; NULL if it is the shipped one. Valid until people change or
 * iso_site_index_follow() is called. */
const struct iso_site_metric *iso_site_index_metric(const struct iso_site_index *site);

/* Computes the vector of a person, of all templates together, by the metric in use. The vectors of
 * the templates are rounded (site_rows.h), unless the metric is the shipped one. Takes some ten
 * microseconds a template. -ENOENT if nobody has this number. */
int iso_site_index_person(const struct iso_site_index *site, int64_t person,
                          struct iso_metric_vector *out) __attribute__((warn_unused_result));

/* Waits until the thread has computed the metric of the present people, and takes it into use. For
 * programs that are not in a hurry. Returns the error of the state. */
int iso_site_index_settle(struct iso_site_index *site);

struct iso_site_state iso_site_index_state(struct iso_site_index *site);

/* The error rates of the present people with the metric in use, which the thread estimates after it
 * has adapted the metric. Returns false while they are not known: the people or the metric have
 * just changed, there was no memory, or the metric does not adapt. */
bool iso_site_index_estimate(struct iso_site_index *site, struct iso_site_estimate *out)
    __attribute__((warn_unused_result));

/* Whether the metric shall adapt to the site and has not done so yet. */
static inline bool iso_site_is_provisional(struct iso_site_state state)
{
    return state.adapts && !state.adapted;
}

#endif
