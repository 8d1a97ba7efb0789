//! Systems that run one after another, as one.

use bevy_ecs::error::{BevyError, Result};
use bevy_ecs::prelude::{IntoSystem, World};
use bevy_ecs::system::{BoxedSystem, RunSystemError};

/// Systems in the order in which they run.
///
/// bevy orders the systems of a schedule anew in every world, a fifth of a millisecond for 25 of them, which is a tenth of a
/// short solve. Where the order is written down there is nothing to find. What stands in here is one node of a schedule: other
/// systems go before it or behind it.
pub struct SystemSequence {
    systems: Vec<BoxedSystem>,
    is_initialized: bool,
}

/// A tuple of systems, one to eight. `M` tells bevy what kinds of functions they are.
pub trait Systems<M> {
    /// The systems, from the first to the last.
    fn boxed(self) -> Vec<BoxedSystem>;
}

macro_rules! tuples_of_systems {
    ($($system:ident $kind:ident),+) => {
        impl<$($kind, $system: IntoSystem<(), (), $kind>),+> Systems<($($kind,)+)> for ($($system,)+) {
            fn boxed(self) -> Vec<BoxedSystem> {
                #[allow(non_snake_case, reason = "types give the variables their names")]
                let ($($system,)+) = self;
                vec![$(Box::new(IntoSystem::into_system($system))),+]
            }
        }
    };
}

tuples_of_systems!(A MA);
tuples_of_systems!(A MA, B MB);
tuples_of_systems!(A MA, B MB, C MC);
tuples_of_systems!(A MA, B MB, C MC, D MD);
tuples_of_systems!(A MA, B MB, C MC, D MD, E ME);
tuples_of_systems!(A MA, B MB, C MC, D MD, E ME, F MF);
tuples_of_systems!(A MA, B MB, C MC, D MD, E ME, F MF, G MG);
tuples_of_systems!(A MA, B MB, C MC, D MD, E ME, F MF, G MG, H MH);
tuples_of_systems!(A MA, B MB, C MC, D MD, E ME, F MF, G MG, H MH, I MI);

impl SystemSequence {
    /// The systems of a tuple, from the first to the last.
    #[must_use]
    pub fn of<M>(systems: impl Systems<M>) -> Self {
        Self::new(systems.boxed())
    }

    /// Systems, from the first to the last.
    #[must_use]
    pub fn new(systems: Vec<BoxedSystem>) -> Self {
        Self { systems, is_initialized: false }
    }

    /// Runs all of them once. It must be the same world every time.
    ///
    /// # Errors
    /// Where a system finds something missing in the world that it asks for; those behind it are not run.
    pub fn run(&mut self, world: &mut World) -> Result {
        if !self.is_initialized {
            self.systems.iter_mut().for_each(|system| drop(system.initialize(world)));
            self.is_initialized = true;
        }
        for system in &mut self.systems {
            system.run((), world).map_err(|error| match error {
                RunSystemError::Skipped(missing) => BevyError::from(missing),
                RunSystemError::Failed(error) => error,
            })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::SystemSequence;
    use bevy_ecs::prelude::{Res, ResMut, Resource, World};

    #[derive(Default, Resource)]
    struct Said(String);

    #[derive(Resource)]
    struct Missing;

    fn say(word: &'static str) -> impl Fn(ResMut<'_, Said>) {
        move |mut said| said.0.push_str(word)
    }

    #[test]
    fn they_run_in_order_every_time_and_see_what_was_written_before_them() {
        let mut world = World::new();
        world.init_resource::<Said>();
        let double = |mut said: ResMut<'_, Said>| said.0 = said.0.repeat(2);
        let mut order = SystemSequence::of((say("a"), double, say("b")));
        assert!(order.run(&mut world).is_ok());
        assert_eq!(world.resource::<Said>().0, "aab");
        assert!(order.run(&mut world).is_ok());
        assert_eq!(world.resource::<Said>().0, "aabaaabab");
    }

    #[test]
    fn what_is_missing_is_an_error_and_stops_those_behind() {
        let mut world = World::new();
        world.init_resource::<Said>();
        let needs = |_: Res<'_, Missing>| {};
        let mut order = SystemSequence::of((say("a"), needs, say("b")));
        assert!(order.run(&mut world).is_err());
        assert_eq!(world.resource::<Said>().0, "a");
    }
}
