#include "enroll/hub/store/hub_act.h"

#include <errno.h>
#include <stdlib.h>

static char *text_of(json_t *value)
{
    char *text = value ? json_dumps(value, JSON_COMPACT | JSON_ENCODE_ANY) : NULL;
    json_decref(value);
    return text;
}

int hub__act_add(struct hub_store *store, const char *what, const char *object, json_t *before,
                 json_t *after, struct iso_fault *fault)
{
    const bool has_before = before, has_after = after;
    char *old = text_of(before), *new = text_of(after);
    struct hub_values values = {.n = 0};
    int error = 0;
    if ((has_before && !old) || (has_after && !new)) {
        error = iso_fault_set(fault, -ENOMEM, "%s: no memory", what);
    } else {
        hub_value_integer(&values, store->now_s());
        hub_value_text(&values, store->actor);
        hub_value_text(&values, what);
        hub_value_text(&values, object);
        hub_value_text(&values, old);
        hub_value_text(&values, new);
        error = hub_db_run(store->db,
                           "INSERT INTO act (time_s, actor, what, object, before, after) "
                           "VALUES ($1, $2, $3, $4, $5::jsonb, $6::jsonb)",
                           &values, NULL, fault);
    }
    free(old);
    free(new);
    return error;
}

int hub_act_each(struct hub_store *store, uint32_t most,
                 int (*each)(void *context, const struct hub_act *act), void *context,
                 struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_integer(&values, most);
    int error = hub_db_run(store->db,
                           "SELECT number, time_s, actor, what, object, before::text, after::text "
                           "FROM (SELECT * FROM act ORDER BY number DESC LIMIT $1) newest "
                           "ORDER BY number",
                           &values, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        const struct hub_act act = {.number = hub_row_integer(rows, i, 0),
                                    .time_s = hub_row_integer(rows, i, 1),
                                    .actor = hub_row_text(rows, i, 2),
                                    .what = hub_row_text(rows, i, 3),
                                    .object = hub_row_text(rows, i, 4),
                                    .before = hub_row_text(rows, i, 5),
                                    .after = hub_row_text(rows, i, 6)};
        error = each(context, &act);
    }
    PQclear(rows);
    return error;
}
