/* What a list of users and a list of groups share: the terms of a filter, and the rows of a page.
 */
#include <errno.h>
#include <string.h>

#include "enroll/hub/scim/scim_rows.h"
#include "firmware/contract/name_folding.h"

const char *hub__scim_term(const struct scim_filter *filter, const char *attribute)
{
    for (size_t i = 0; i < filter->n; i++) {
        if (strcmp(filter->terms[i].attribute, attribute) == 0) {
            return filter->terms[i].value;
        }
    }
    return NULL;
}

int hub__scim_check_terms(const struct scim_filter *filter, const char *const *names,
                          struct iso_fault *fault)
{
    for (size_t i = 0; i < filter->n; i++) {
        const struct scim_term *term = &filter->terms[i];
        const char *const *name = names;
        while (*name && strcmp(*name, term->attribute) != 0) {
            name++;
        }
        if (!*name) {
            return iso_fault_set(fault, -EDOM, "%.80s cannot be filtered by", term->attribute);
        }
        if (hub__scim_term(filter, term->attribute) != term->value) {
            return iso_fault_set(fault, -EDOM, "%.80s is compared twice", term->attribute);
        }
    }
    return 0;
}

int hub__scim_fold(const char *text, char **out, struct iso_fault *fault)
{
    const int error = iso_name_fold(text, out);

    return error ? iso_fault_set(fault, error, "%.80s: cannot be folded", text) : 0;
}

int hub__scim_page_rows(struct hub_store *store, const struct scim_page *page,
                        const struct scim_page_query *query, struct hub_values *filter,
                        int64_t *total, PGresult **rows, struct iso_fault *fault)
{
    PGresult *counted = NULL;
    const int error = hub_db_run(store->db, query->count, filter, &counted, fault);

    if (error) {
        return error;
    }
    *total = hub_row_integer(counted, 0, 0);
    PQclear(counted);
    hub_value_integer(filter, page->start - 1);
    hub_value_integer(filter, page->count);
    hub_value_switch(filter, page->related);
    return hub_db_run(store->db, query->select, filter, rows, fault);
}
