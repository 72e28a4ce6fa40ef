//! The bodies of a recording: their shapes, and their colours, which change where they are stuck or interfere.

use super::{BODIES_TOPIC, FRAMES_TOPIC, SCENE_TOPIC, START, TrajectoryRecorder, put, stamp};
use crate::RecordError;
use crate::log::Topic;
use crate::scene::{Body, State, surface, update};
use foxglove::messages::{FrameTransform, FrameTransforms};

/// The bodies that the scene shows.
pub(super) struct Shown {
    topic: Topic,
    bodies: Vec<Body>,
    /// The topic of the cloud of each body.
    clouds: Vec<Topic>,
    state: State,
    /// The numbers of the bodies that interfere.
    interfering: Vec<usize>,
}

impl TrajectoryRecorder<'_> {
    /// Writes the shapes of the bodies.
    pub(super) fn show(&mut self, bodies: &[Body]) -> Result<(), RecordError> {
        let topic = self.log.topic::<foxglove::messages::SceneUpdate>(SCENE_TOPIC)?;
        let cloud = |body: &Body| {
            let name = format!("{BODIES_TOPIC}{}", body.frame);
            self.log.topic::<foxglove::messages::PointCloud>(&name)
        };
        let clouds = bodies.iter().map(cloud).collect::<Result<_, _>>()?;
        self.scene = Some(Shown {
            topic,
            bodies: bodies.to_vec(),
            clouds,
            state: State::Moves,
            interfering: Vec::new(),
        });
        self.draw(START)?;
        for number in 0..bodies.len() {
            self.draw_cloud(START, number)?;
        }
        let transform = |body: &Body| {
            body.parent.map(|parent| FrameTransform {
                timestamp: None,
                parent_frame_id: bodies[parent].frame.clone(),
                child_frame_id: body.frame.clone(),
                translation: None,
                rotation: None,
            })
        };
        let transforms = bodies.iter().filter_map(transform).collect();
        let topic = self.log.topic::<FrameTransforms>(FRAMES_TOPIC)?;
        self.frames = Some((topic, FrameTransforms { transforms }));
        Ok(())
    }

    /// Writes the scene in its present state.
    fn draw(&mut self, time: u64) -> Result<(), RecordError> {
        let Some(Shown { topic, bodies, state, interfering, .. }) = &mut self.scene else {
            return Ok(());
        };
        let scene = update(bodies, (*state, interfering), stamp(time));
        put(&mut self.log, &mut self.message, topic, time, &scene)
    }

    /// Writes the surface of a body in its present colours.
    fn draw_cloud(&mut self, time: u64, number: usize) -> Result<(), RecordError> {
        let Some(Shown { bodies, clouds, state, interfering, .. }) = &mut self.scene else {
            return Ok(());
        };
        let look = (*state, interfering.contains(&number));
        let cloud = surface(&bodies[number], bodies, look, stamp(time))?;
        self.log.message(&mut clouds[number], time, &cloud)
    }

    /// Writes the scene anew where the bodies get stuck, or move again, and where others interfere.
    pub(super) fn draw_change(
        &mut self,
        time: u64,
        (now, interfering): (State, Option<&[usize]>),
    ) -> Result<(), RecordError> {
        match &mut self.scene {
            Some(shown)
                if shown.state != now
                    || interfering.is_some_and(|all| shown.interfering != all) =>
            {
                let before = std::mem::replace(&mut shown.state, now);
                let mut red = shown.interfering.clone();
                if let Some(interfering) = interfering {
                    std::mem::swap(&mut red, &mut shown.interfering);
                    shown.interfering = interfering.to_vec();
                }
                let look = |state, red: &[usize], number| (state, red.contains(&number));
                let changed: Vec<usize> = (0..shown.bodies.len())
                    .filter(|&i| look(before, &red, i) != look(now, &shown.interfering, i))
                    .collect();
                self.draw(time)?;
                changed.into_iter().try_for_each(|number| self.draw_cloud(time, number))
            }
            _ => Ok(()),
        }
    }
}
