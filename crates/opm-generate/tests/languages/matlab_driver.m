% Answers the questions of the input, one after the other.
function driver(name, counts)
  n = counts(1); n_joints = counts(2); n_imaginary = counts(3); n_actuated = counts(4);
  input_file = fopen(fullfile(getenv('CODE'), 'input'), 'r');
  bytes = fread(input_file, Inf, 'uint8=>uint8')';
  fclose(input_file);
  has_forward = exist(fullfile(getenv('CODE'), ['+' name], 'forward.m'), 'file') > 0;
  f = @(what) str2func([name '.' what]);
  inverse = f('inverse'); actuated = f('actuated'); deficits = f('deficits'); limits = f('limits');
  transform = f('transform'); nearest = f('nearest'); jacobian = f('jacobian'); twist = f('twist'); rates = f('rates');
  if has_forward
    forward = f('forward');
  end
  has_dynamics = exist(fullfile(getenv('CODE'), ['+' name], 'inverse_dynamics.m'), 'file') > 0;
  if has_dynamics
    inverse_dynamics = f('inverse_dynamics');
  end
  default_geometry = f('default');
  g = default_geometry();
  size_of = 4 + 16 * n;
  out = [];
  for i = 0:(numel(bytes) / size_of - 1)
    record = bytes(i * size_of + (1:size_of));
    mode = double(typecast(record(1:4), 'uint32'));
    numbers = typecast(record(5:end), 'double');
    pose = numbers(1:n);
    next = numbers(n + 1:end);
    [status, joints, imaginary] = inverse(g, pose, mode);
    reached = status == 0;
    if ~reached
      joints = -77 * ones(1, n_joints);
    end
    out = [out, one(status, joints, imaginary)];
    [status, driven] = actuated(g, pose, mode);
    out = [out, one(status, driven)];
    [status, missed] = deficits(g, pose, mode);
    out = [out, status, missed, limits(g, joints)];
    [status, position, rotation] = transform(g, pose, mode);
    out = [out, one(status, position, rotation)];
    [status, near_mode, near, near_imaginary] = nearest(g, next, joints);
    out = [out, one(status, near_mode, near, near_imaginary)];
    [status, found] = jacobian(g, pose, mode);
    out = [out, one(status, found)];
    [status, found] = twist(g, pose, mode);
    out = [out, one(status, found)];
    [status, found] = rates(g, pose, mode, next);
    out = [out, one(status, found)];
    if has_dynamics
      [status, found] = inverse_dynamics(g, pose, mode, next, pose);
      out = [out, 1, one(status, found)];
    else
      out = [out, 0];
    end
    if has_forward
      if ~reached
        driven = -77 * ones(1, n_actuated);
      end
      [status, found, residual] = forward(g, driven, mode, next);
      out = [out, 1, status, residual, found];
      driven(end) = NaN;
      out = [out, forward(g, driven, mode, pose)];
    else
      out = [out, 0];
    end
  end
  fwrite(stdout, out, 'double');
end

function numbers = one(status, varargin)
  numbers = [varargin{:}];
  if status ~= 0
    numbers(:) = -77;
  end
  numbers = [status, numbers];
end
