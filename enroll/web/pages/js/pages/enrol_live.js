/* The enrolment while it goes on: the relief, the steps with their pictures, the hint, and the
 * quality of each frame. It ends by its result, or by the button; Esc does not end it. */

import {_, _f} from '../base/i18n.js';
import {fill, h, say} from '../base/dom.js';
import {number, percent} from '../base/format.js';
import {HINTS, POSES, STEP_STATES, word} from '../base/words.js';
import {confirm} from '../view/dialog.js';
import {checkbox} from '../view/fields.js';
import {headPicture} from '../view/head_picture.js';
import {holdHint} from '../view/hint_hold.js';
import {noticeFault} from '../view/notice.js';
import {reliefView} from '../view/relief_view.js';

const STRAIGHT = ['not-a-face', 'no-face', 'no-face-in-image', 'nobody'];
const ORDER = ['frontal', 'left', 'right', 'down', 'up'];

/* The state of each pose: {pose, state, turn_deg}; those that have not begun have no state. */
function stepsOf(enrolment) {
    const known = new Map((enrolment.steps ?? []).map((step) => [step.pose, step]));
    const poses = enrolment.poses === false ? ['frontal'] : ORDER;
    return poses.map((pose) => known.get(pose) ?? { pose });
}

function stepList(steps, now) {
    return h(
        'ol', { class: 'steps' },
        steps.map(
            (step) =>
                h('li', {
                    class: step === now ? 'now' : step.state ?? 'ahead',
                    'aria-current': step === now ? 'step' : undefined
                },
                  headPicture(step.pose), h('span', {}, word(POSES, step.pose)),
                  h('span', { class: 'quiet' },
                    step === now                                             ? _('now') :
                        step.state === 'passed' || step.state === 'left-out' ? word(STEP_STATES, step.state) :
                                                                               '\u00a0'))));
}

function bars(captures) {
    return captures.map((quality, i) => {
        const share = Math.max(0, Math.min(1, Number(quality) || 0));
        const bar = h('span', { class: 'bar' });
        bar.style.blockSize = `${8 + 40 * share}px`;
        return h(
            'li', { title: percent(share) }, bar,
            h('span', { class: 'unseen' }, _f('Frame {n}: {quality}', { n: number(i + 1), quality: percent(share) })));
    });
}

export function enrolLive({api, hub}, ended) {
    const view = reliefView(_('Relief of the face'));
    const mirror = checkbox(
        _('As in a mirror'), { checked: true, onchange: () => element.classList.toggle('mirror', mirror.box.checked) });
    const picture = api.can.relief && h('div', {}, h('div', { class: 'picture' }, view.element), mirror.element);
    const hint = h('p', { class: 'hint', role: 'status', 'aria-live': 'polite' });
    const hold = holdHint((text) => say(hint, text));
    const progress = h('progress', { 'aria-label': _('Progress') });
    const steps = h('div', {});
    const quality = h('ul', { class: 'bars', 'aria-label': _('Quality of each frame') });
    const stop = h('button', { type: 'button', class: 'danger' }, _('Stop the enrolment…'));
    let drawn = '';
    let pose = '';
    let over = false;

    function hintOf(enrolment, now) {
        /* "Look straight" is wrong for a pose to the side. */
        const silent = now?.pose && now.pose !== 'frontal' && STRAIGHT.includes(enrolment.hint);
        const text =
            (!silent && word(HINTS, enrolment.hint)) || word(POSES, now?.pose) || _('Look straight at the camera');
        return enrolment.hint && now?.state === 'turn' && now.turn_deg > 0 ?
            _f('{hint}, by about {degrees}°', { hint: text, degrees: number(now.turn_deg) }) :
            text;
    }

    function draw(enrolment) {
        if (over || !enrolment) {
            return;
        }
        if (enrolment.state !== 'running') {
            over = true;
            ended(enrolment);
            return;
        }
        const all = stepsOf(enrolment);
        const now =
            all.find((step) => step.state === 'begun' || step.state === 'turn') ?? all.find((step) => !step.state);
        hold(hintOf(enrolment, now), pose !== now?.pose);
        pose = now?.pose;
        progress.max = enrolment.stages || 1;
        progress.value = Math.min(progress.max, enrolment.stage ?? 0);
        const state = JSON.stringify([all.map((step) => [step.pose, step.state]), enrolment.captures]);
        if (state !== drawn) {
            drawn = state;
            fill(steps, stepList(all, now));
            fill(quality, bars(enrolment.captures ?? []));
        }
    }

    stop.addEventListener('click', async () => {
        if (!await confirm(
                _('Stop the enrolment?'), _('Nobody is enrolled then.'), _('Stop the enrolment'), { danger: true })) {
            return;
        }
        try {
            await api.endEnrolment();
        } catch (error) {
            if (error.code !== 'no-enrolment') {
                noticeFault(error);
            }
        }
    });
    const warn = (event) => event.preventDefault();
    addEventListener('beforeunload', warn);
    const ends = [
        hub.on('enrolment', draw),
        /* What was missed while there was no connection. */
        hub.on(
            'connection',
            (up) => up &&
                api.enrolment()
                    .then((now) => {
                        hub.enrolment = now;
                        draw(now);
                    })
                    .catch(() => {}))
    ];
    const follow = () => api.relief((record) => view.draw(record, mirror.box.checked), () => {});
    let stream = follow();
    /* A short enrolment may be over before this page listens. */
    setTimeout(() => draw(hub.enrolment), 0);
    const element =
        h('div', { class: 'enrol mirror panel' }, h('h2', {}, h('bdi', {}, hub.enrolment?.person ?? '')),
          h('div', { class: 'columns' }, picture, h('div', {}, hint, progress, quality)), steps,
          h('div', { class: 'buttons start' }, stop));
    return {
        element,
        resume() {
            stream.close();
            stream = follow();
        },
        leave() {
            over = true;
            stream.close();
            removeEventListener('beforeunload', warn);
            ends.forEach((end) => end());
        },
    };
}
