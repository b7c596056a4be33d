"""How drones turn commands into forces."""

import json
from itertools import chain
from typing import Any

import numpy as np
from pydantic import ValidationError

from drone_engine.arrays import Floats
from drone_engine.context import Context, Stages
from drone_engine.effects import weight
from drone_engine.extension import ExtensionError, find, member
from drone_engine.flight import direct, pilot, quadrotor
from drone_engine.scene.errors import SceneError, first_error
from drone_engine.scene.schema import FLIGHT_MODELS, Scene


def build(context: Context, scene: Scene) -> Stages:
    """The stages of the pilot and of the flight models that the scene's drones have. Raises SceneError."""
    drones, carried = context.model.drones, weight(context.active)
    wanted = np.zeros((len(drones.body), 4))
    models = [Stages(step=(pilot.build(context, wanted),))]
    of = np.array([flight.model for flight in drones.flights])
    if (of == "direct").any():
        models.append(direct.build(context, np.flatnonzero(of == "direct"), wanted, carried))
    if (of == "quadrotor").any():
        models.append(quadrotor.build(context, np.flatnonzero(of == "quadrotor"), wanted, carried, scene.path))
    models += [_user_model(context, scene, d, wanted, carried)
               for d, name in enumerate(of) if name not in FLIGHT_MODELS]
    return Stages(step=tuple(chain(*(each.step for each in models))),
                  substep=tuple(chain(*(each.substep for each in models))),
                  force=tuple(chain(*(each.force for each in models))))


def _user_model(context: Context, scene: Scene, drone: int, wanted: Floats, weight: float) -> Stages:
    """The stages of a drone with a flight model of the user's own: a module with `Parameters` and
    `build(parameters, context, drone, wanted, weight)`; drone: (1,) its index. Raises SceneError."""
    flight = context.model.drones.flights[drone]
    key = f"objects.{context.model.bodies.names[context.model.drones.body[drone]]}.flight"
    try:
        module: Any = find("flight_models", flight.model, scene.folder, FLIGHT_MODELS)
        schema, make = member(module, flight.model, "Parameters"), member(module, flight.model, "build")
        parameters = schema.model_validate_json(json.dumps(flight.parameters), strict=True)
    except ExtensionError as error:
        raise SceneError(f"{scene.path}: {key}.model: '{flight.model}': {error}") from error.__cause__
    except ValidationError as error:
        raise SceneError(f"{scene.path}: {first_error(error, schema, (*key.split('.'), 'parameters'))}") from None
    stages: Stages = make(parameters, context, np.array([drone]), wanted, weight)
    return stages
