#include "sim/lab/measure/people_rate.h"

#include <math.h>

void sim_people_rate_add(struct sim_people_rate *rate, struct sim_rate person)
{
    const double errors = (double)person.events, visits = (double)person.trials;
    rate->visits.events += person.events;
    rate->visits.trials += person.trials;
    rate->people++;
    rate->errors_squared += errors * errors;
    rate->errors_times_visits += errors * visits;
    rate->visits_squared += visits * visits;
}

double sim_people_rate_effective(const struct sim_people_rate *rate)
{
    const double people = (double)rate->people, visits = (double)rate->visits.trials;
    if (rate->visits.trials == rate->people) {
        return visits; /* one visit each */
    }
    if (rate->visits.events == 0 || rate->visits.events == rate->visits.trials || people < 2.0) {
        return people;
    }
    const double p = sim_rate_value(rate->visits);
    const double residuals = rate->errors_squared - 2.0 * p * rate->errors_times_visits +
                             p * p * rate->visits_squared;
    const double variance = people / (people - 1.0) * residuals / (visits * visits);
    return variance > 0.0 ? fmin(visits, p * (1.0 - p) / variance) : visits;
}

struct sim_interval sim_people_rate_interval(const struct sim_people_rate *rate)
{
    if (rate->people == 0) {
        return (struct sim_interval){0.0, 1.0};
    }
    return sim_rate_effective_interval(sim_rate_value(rate->visits),
                                       sim_people_rate_effective(rate));
}
