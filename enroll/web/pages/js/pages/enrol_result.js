/* How an enrolment ended, in words. */

import {_, _f} from '../base/i18n.js';
import {h} from '../base/dom.js';
import {number} from '../base/format.js';
import {POSES, RESULTS, word} from '../base/words.js';

export function enrolResult(enrolment, another, again) {
    const good = enrolment.result === 'completed';
    const omitted = (enrolment.steps ?? []).filter((step) => step.state === 'left-out');
    return h(
        'div', { class: `panel result ${good ? 'good' : 'bad'}` },
        h('h2', { tabindex: -1 }, h('span', { class: 'sign', 'aria-hidden': 'true' }, good ? '✓ ' : '✕ '),
          h('bdi', {}, enrolment.person ?? '')),
        h('p', { role: 'status' }, word(RESULTS, enrolment.result) || _('The enrolment has ended.')),
        enrolment.known_as && h('p', {}, _f('The face is enrolled as {name}.', { name: enrolment.known_as })),
        enrolment.detail && h('p', { lang: 'en' }, enrolment.detail),
        good && h('p', {}, _f('Usable frames: {n}', { n: number((enrolment.captures ?? []).length) })),
        good && omitted.length > 0 &&
            h('p', {}, _('Left out, because the pose was not reached in time:'), ' ',
              omitted.map((step) => word(POSES, step.pose)).join(' · ')),
        h('div', { class: 'buttons start' }, !good && h('button', { type: 'button', onclick: again }, _('Try again')),
          h('button', { type: 'button', class: good ? '' : 'plain', onclick: another }, _('Enrol another person')),
          h('a', { class: 'button plain', href: '#people' }, _('Show people'))));
}
